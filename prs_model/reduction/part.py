"""From a body of the description to its super-element: read, reduce, check, store."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import ValidationError

from .. import plugins
from ..description.messages import report
from ..description.problems import Place, Problems
from ..description.schema import Body, Coupling, Interface, ReductionDefaults, Section
from ..description.units import SI, Units
from ..errors import PartFileError, PrsError
from ..finite_elements import FiniteElementModel
from .from_model import reduce_model
from .recipe import Settings, file_hash, recipe
from .retained import named_by_interfaces
from .stations import reduce_travelling, travelling_interface
from .store import Element, StoredPart
from .super_element import SuperElement
from .travelling import TravellingElement

logger = logging.getLogger("prs_model")

S = TypeVar("S", bound=Section)

MOST_KEPT = 64
_made: dict[tuple[object, ...], Element] = {}  # the latest elements of this process, oldest first


def build_part(
    name: str,
    body: Body,
    defaults: ReductionDefaults,
    folder: Path,
    *,
    stem: str | None = None,
    units: Units = SI,
) -> SuperElement | TravellingElement:
    """The super-element of a body: from the store when it is there and up to date, else read, reduced and stored.

    name: the body's, for messages; stem: the entry it was expanded from (``rod`` of ``rod_2``), under which it is
    stored once for all; folder: the machine's, to which `source` and the store are relative; units: of the options
    as written. Raises UnknownNameError, DescriptionError, PartFileError or PhysicsError.
    """
    stem = stem or name
    reducer = plugins.reducer(body.reducer)
    options = validated(reducer.Options, body.options, f"part {stem}", ("bodies", stem, "options"), units)
    settings = Settings.of(body, defaults)
    source = _source(stem, body, folder, reducer)
    request = plugins.PartRequest(stem, source, options, _file_units(stem, body, folder), body)
    if source is None:
        return _read(reducer, request, body, settings)[0]
    text = recipe(body, options, settings, reducer.version)
    store = None if defaults.store is None else StoredPart(folder / defaults.store, stem, text, source)
    element = _made.get(_key(stem, text, source, store))
    if element is None:
        element = _found_or_made(reducer, request, body, settings, text, store)
        _made[_key(stem, text, source, store)] = element
        if len(_made) > MOST_KEPT:
            del _made[next(iter(_made))]
    return _travelling_with(element, body)


def reduce(
    reducer: str,
    source: str | Path | None = None,
    *,
    interfaces: Mapping[str, Interface | Mapping[str, Any]] | None = None,
    units: str | None = None,
    modes: int = 3,
    coupling: Coupling = "rigid",
    grounded: bool = False,
    clamped: Iterable[str] = (),
    **options: Any,
) -> SuperElement:
    """Read one part with any reducer plug-in and reduce it, outside of a machine.

    interfaces: as in machine.yaml, by name; units: of the part file, such as ``mm-N-tonne-s``. Everything given here
    (options, places of interfaces) is in SI. Raises UnknownNameError, DescriptionError, PartFileError, PhysicsError.
    """
    name = Path(source).stem if source is not None else reducer
    entries = {
        "frame": name,
        "reducer": reducer,
        "source": None if source is None else str(source),
        "units": units,
        "options": options,
        "interfaces": interfaces or {},
        "clamped": tuple(clamped),
        "grounded": grounded,
        "modes": modes,
        "coupling": coupling,
    }
    body = validated(Body, entries, f"reduce('{reducer}', ...)", (), SI)
    element = build_part(name, body, ReductionDefaults(), Path())
    if isinstance(element, TravellingElement):
        raise PrsError(f"reduce: interface of {name} travels with joint {element.joint}; describe a machine for that")
    return element


def validated(section: type[S], entries: Mapping[str, Any], file: str, place: Place, units: Units) -> S:
    """Entries as a section, in SI. Raises DescriptionError with every problem, placed at `place` in `file`."""
    plain = _plain(entries)
    try:
        return section.model_validate(plain, context={"units": units})
    except ValidationError as error:
        problems = Problems(file, {})
        report(error, section, plain, problems, place)
        problems.raise_if_any()
        raise


def _plain(value: Any) -> Any:
    """Lists and arrays as tuples, sections as mappings, as the sections' strict validation wants them."""
    if isinstance(value, Section):
        return _plain({name: getattr(value, name) for name in value.model_fields_set})
    if isinstance(value, Mapping):
        return {name: _plain(each) for name, each in value.items()}
    if isinstance(value, np.ndarray):
        return _plain(value.tolist())
    if isinstance(value, list | tuple):
        return tuple(map(_plain, value))
    return value


def _source(name: str, body: Body, folder: Path, reducer: plugins.Reducer) -> Path | None:
    if not reducer.needs_source:
        return None
    if body.source is None:
        raise PartFileError(folder, f"bodies.{name}.source: found nothing, reducer '{body.reducer}' reads a part file")
    return folder / body.source


def _file_units(name: str, body: Body, folder: Path) -> Units | None:
    try:
        return None if body.units is None else Units.parse(body.units)
    except ValueError as error:
        raise PartFileError(folder / (body.source or ""), f"bodies.{name}.units: {error}") from error


def _key(stem: str, text: str, source: Path, store: StoredPart | None) -> tuple[object, ...]:
    stored = (None, None) if store is None else (store.path.resolve(), _stamp(store.path))
    return stem, text, source.resolve(), _stamp(source), *stored


def _stamp(path: Path) -> tuple[int, int] | None:
    """What changes when a file does; None when there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size


def _found_or_made(
    reducer: plugins.Reducer,
    request: plugins.PartRequest,
    body: Body,
    settings: Settings,
    text: str,
    store: StoredPart | None,
) -> Element:
    stored = store.find() if store is not None else None
    if stored is not None:
        stored.check()
        return stored
    if request.source is None or not request.source.exists():
        raise PartFileError(
            request.source or request.name, f"there is no such file; correct bodies.{request.name}.source"
        )
    element, reduced_here = _read(reducer, request, body, settings)
    made_from = {"recipe": text, "source": str(body.source), "source_sha256": file_hash(request.source)}
    element = _with_provenance(element, made_from)
    if store is not None and reduced_here:
        store.keep(element)
    return element


def _read(
    reducer: plugins.Reducer, request: plugins.PartRequest, body: Body, settings: Settings
) -> tuple[Element, bool]:
    """The element past the gate, and whether its reduction was ours."""
    part = reducer.read(request)
    place = str(request.source or f"bodies.{request.name}")
    if isinstance(part, FiniteElementModel):
        element, ours = _from_model(part, body, settings, place), True
    else:
        element, ours = named_by_interfaces(part, body.interfaces, place), False
        element = replace(element, grounded=element.grounded or body.grounded)
    element = _with_provenance(element, {"name": request.name, "reducer": body.reducer})
    element.check()
    return element, ours


def _from_model(model: FiniteElementModel, body: Body, settings: Settings, place: str) -> Element:
    model = replace(model, provenance={**model.provenance, "name": Path(place).stem, "source": place})
    if body.clamped:
        model = model.clamp(body.clamped)
    logger.info("%s: reducing %d DOFs", model.name, model.size)
    travels = travelling_interface(body.interfaces, place) is not None
    return (reduce_travelling if travels else reduce_model)(model, body.interfaces, settings, grounded=body.grounded)


def _with_provenance(element: Element, more: Mapping[str, str]) -> Element:
    if isinstance(element, TravellingElement):
        return replace(element, elements=tuple(_stamped(each, more) for each in element.elements))
    return _stamped(element, more)


def _stamped(element: SuperElement, more: Mapping[str, str]) -> SuperElement:
    return replace(element, provenance={**element.provenance, **more})


def _travelling_with(element: Element, body: Body) -> Element:
    """A travelling part of another limb travels with that limb's joint."""
    joints = [each.travel.joint for each in body.interfaces.values() if each.travel is not None]
    if isinstance(element, TravellingElement) and joints and joints[0] != element.joint:
        return replace(element, joint=joints[0])
    return element
