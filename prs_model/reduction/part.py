"""From a body of the description, or the arguments of `reduce`, to a super-element: read, reduce, check, store."""

from __future__ import annotations

import logging
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import ValidationError

from .. import plugins
from ..arrays import FloatArray
from ..description.interface import Coupling, Interface, NodeId
from ..description.messages import report
from ..description.problems import Place, Problems
from ..description.schema import Body, ReductionDefaults, Section
from ..description.units import SI, Units
from ..errors import PartFileError, PrsError
from ..finite_elements import FiniteElementModel
from .expected import check_expected
from .from_model import reduce_model
from .model_gate import check_model
from .recipe import Settings, recipe
from .retained import at_interfaces
from .stations import reduce_travelling, travelling_interface
from .store import Element, StoredPart, files_hash
from .summary import echo
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
) -> SuperElement | TravellingElement:
    """The super-element of a body: from the store when it is there and up to date, else read, reduced and stored.

    name: the body's, for messages; stem: the entry it was expanded from (``rod`` of ``rod_2``), under which it is
    stored once for all; folder: the machine's, to which `source` and the store are relative.
    Raises UnknownNameError, DescriptionError, PartFileError or PhysicsError.
    """
    stem = stem or name
    reducer, request = _asked(stem, body, folder)
    settings = Settings.of(body, defaults)
    if request.source is None:
        element: Element = _read(reducer, request, body, settings)[0]
    else:
        element = _from_file(reducer, request, body, settings, defaults, folder)
    if body.expected is not None:
        check_expected(element, body.expected)
    return _travelling_with(element, body)


def reduce(
    reducer: str,
    source: str | Path | None = None,
    *,
    nodes: Mapping[str, Any] | None = None,
    interfaces: Mapping[str, Interface | Mapping[str, Any]] | None = None,
    units: str | None = None,
    modes: int | None = None,
    coupling: Coupling = "rigid",
    grounded: bool = False,
    clamped: Iterable[str] = (),
    expected: Mapping[str, float] | None = None,
    options: Mapping[str, Any] | None = None,
    **more: Any,
) -> SuperElement:
    """Read one part with any reducer plug-in and reduce it, outside of a machine.

    nodes: short for interfaces that are one node or several, such as ``{"tip": 3, "root": [11, 19]}`` (a reducer with
    an option of that name gets it instead); interfaces: as in machine.yaml, by name; units: of the part file, such as
    ``mm-N-tonne-s``; modes: how many to keep of a part that is reduced here (default 3); expected: `mass` [kg] and
    `frequency` [Hz] that are known; options: of the reducer, as a mapping or by name (`**more`). Everything given here
    (options, places of interfaces) is in SI. The same call for
    the same file gives the same element again, without reading it.
    Raises UnknownNameError, DescriptionError, PartFileError, PhysicsError.
    """
    options = _options(reducer, options, more)
    if nodes is not None and "nodes" in plugins.reducer(reducer).Options.model_fields:
        nodes, options = None, {**options, "nodes": nodes}
    entries = {
        **_entries(reducer, source, units, options),
        "interfaces": {**_at_nodes(nodes or {}), **(interfaces or {})},
        "clamped": tuple(clamped),
        "grounded": grounded,
        "expected": expected,
        "modes": modes,
        "coupling": coupling,
    }
    body = validated(Body, entries, f"reduce('{reducer}', ...)", (), SI)
    element = build_part(body.frame, body, ReductionDefaults(), Path())
    if isinstance(element, TravellingElement):
        travels = f"interface of {body.frame} travels with joint {element.joint}"
        raise PrsError(f"reduce: {travels}; describe a machine for that")
    return element


def read_part(
    reducer: str,
    source: str | Path | None = None,
    *,
    units: str | None = None,
    options: Mapping[str, Any] | None = None,
    **more: Any,
) -> FiniteElementModel | SuperElement:
    """What a reducer reads of a part, in SI, before interfaces, reduction and the physics gate.

    units: of the part file; options: of the reducer, in SI, as a mapping or by name (`**more`).
    Raises UnknownNameError, DescriptionError, PartFileError.
    """
    options = _options(reducer, options, more)
    body = validated(Body, _entries(reducer, source, units, options), f"read_part('{reducer}', ...)", (), SI)
    plugin, request = _asked(body.frame, body, Path())
    return plugin.read(request)


def _options(reducer: str, options: Mapping[str, Any] | None, more: Mapping[str, Any]) -> dict[str, Any]:
    if twice := (options or {}).keys() & more.keys():
        raise PrsError(f"reducer '{reducer}': option '{min(twice)}' is given twice, by name and in 'options'")
    return {**(options or {}), **more}


def _entries(reducer: str, source: str | Path | None, units: str | None, options: Mapping[str, Any]) -> dict[str, Any]:
    return {
        "frame": Path(source).stem if source is not None else reducer,
        "reducer": reducer,
        "source": None if source is None else str(source),
        "units": units,
        "options": options,
    }


def _at_nodes(nodes: Mapping[str, NodeId | Sequence[NodeId]]) -> dict[str, dict[str, Any]]:
    return {
        name: {"node": each} if isinstance(each, int | str) else {"nodes": tuple(each)} for name, each in nodes.items()
    }


def _asked(name: str, body: Body, folder: Path) -> tuple[plugins.Reducer[Any], plugins.PartRequest[Any]]:
    """The reducer of a body, and what it is asked for."""
    reducer = plugins.reducer(body.reducer)
    options = validated(reducer.Options, body.options, f"part {name}", ("options",), SI)
    source = _source(name, body, folder, reducer)
    return reducer, plugins.PartRequest(name, source, options, _file_units(body, source, reducer), body)


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


def _source(name: str, body: Body, folder: Path, reducer: plugins.Reducer[Any]) -> Path | None:
    if not reducer.needs_source:
        return None
    if body.source is None:
        raise PartFileError(folder, f"bodies.{name}.source: found nothing, reducer '{body.reducer}' reads a part file")
    return folder / body.source


def _file_units(body: Body, source: Path | None, reducer: plugins.Reducer[Any]) -> Units | None:
    """The part file's units as said, where the reducer wants them said."""
    place = source or body.reducer
    if body.units is None:
        if source is not None and reducer.units == "asked":
            raise PartFileError(place, plugins.NO_UNITS)
        return None
    if source is None or reducer.units == "SI":
        raise PartFileError(place, f"reducer '{body.reducer}' takes SI only: leave 'units' out")
    try:
        return Units.parse(body.units)
    except ValueError as error:
        raise PartFileError(place, f"units: {error}") from error


def _key(stem: str, text: str, files: Sequence[Path], store: StoredPart | None) -> tuple[object, ...]:
    stored = (None, None) if store is None else (store.path.resolve(), _stamp(store.path))
    return stem, text, *((file.resolve(), _stamp(file)) for file in files), *stored


def _stamp(path: Path) -> tuple[int, int] | None:
    """What changes when a file does; None when there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size


def _from_file(
    reducer: plugins.Reducer[Any],
    request: plugins.PartRequest[Any],
    body: Body,
    settings: Settings,
    defaults: ReductionDefaults,
    folder: Path,
) -> Element:
    """The element of a part file, remembered for as long as its files, its recipe and the store stay as they are."""
    stem, files = request.name, tuple(reducer.files(request))
    text = recipe(body, request.options, settings, reducer.version)
    store = None if defaults.store is None else StoredPart(folder / defaults.store, stem, text, files)
    element = _made.get(_key(stem, text, files, store))
    if element is None:
        element = _found_or_made(reducer, request, body, settings, text, files, store)
        _made[_key(stem, text, files, store)] = element
        if len(_made) > MOST_KEPT:
            del _made[next(iter(_made))]
    return element


def _found_or_made(
    reducer: plugins.Reducer[Any],
    request: plugins.PartRequest[Any],
    body: Body,
    settings: Settings,
    text: str,
    files: Sequence[Path],
    store: StoredPart | None,
) -> Element:
    stored = store.find() if store is not None else None
    if stored is not None:
        stored.check()
        return stored
    if not files[0].exists():
        raise PartFileError(files[0], f"there is no such file; correct bodies.{request.name}.source")
    element, points = _read(reducer, request, body, settings)
    made_from = {"recipe": text, "source": str(body.source), "source_sha256": files_hash(files)}
    element = _with_provenance(element, made_from)
    echo(element, request.name, points)
    if store is not None and points is not None:
        store.keep(element)
    return element


def _read(
    reducer: plugins.Reducer[Any], request: plugins.PartRequest[Any], body: Body, settings: Settings
) -> tuple[Element, FloatArray | None]:
    """The element past the gate, and the nodes (n, 3) [m] of the full model where the reduction was ours."""
    part = reducer.read(request)
    place = str(request.source or f"bodies.{request.name}")
    if isinstance(part, FiniteElementModel):
        element, points = _from_model(part, body, settings, request.name, place), part.coordinates
    else:
        element, points = _as_reduced(part, body, settings, place), None
    element = _with_provenance(element, {"name": request.name, "reducer": body.reducer})
    element.check()
    return element, points


def _as_reduced(element: SuperElement, body: Body, settings: Settings, place: str) -> SuperElement:
    full_only = {"modes": body.modes is not None, "clamped": bool(body.clamped)}
    for entry, given in full_only.items():
        if given:
            raise PartFileError(place, f"{entry}: the part is already reduced, and keeps what it has; remove '{entry}'")
    element = replace(element, grounded=element.grounded or body.grounded)
    return at_interfaces(element, body.interfaces, settings, place)


def _from_model(model: FiniteElementModel, body: Body, settings: Settings, name: str, place: str) -> Element:
    model = replace(model, provenance={**model.provenance, "name": name, "source": place})
    check_model(model, grounded=body.grounded and not body.clamped)
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
