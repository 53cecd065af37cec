"""From a body of the description, or the arguments of `reduce`, to what a reducer is asked for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
from pydantic import ValidationError

from .. import plugins
from ..description.interface import NodeId
from ..description.messages import report
from ..description.problems import Place, Problems
from ..description.schema import Body
from ..description.section import Section
from ..description.units import SI, Units
from ..errors import PartFileError, PrsError

S = TypeVar("S", bound=Section)


def body_of(reducer: str, source: str | Path | None, units: str | None, **more: Any) -> Body:
    """The body that a call of `reduce` describes, in SI. Raises DescriptionError with every problem."""
    entries = {
        "frame": reducer if source is None else part_name(source),
        "reducer": reducer,
        "source": None if source is None else str(source),
        "units": units,
        **more,
    }
    return validated(Body, entries, f"reducer '{reducer}'", (), SI)


def part_name(source: str | Path) -> str:
    """``rod`` of ``meshes/rod.sti.gz``."""
    return Path(Path(source).name.removesuffix(".gz")).stem


def all_options(reducer: str, options: Mapping[str, Any] | None, more: Mapping[str, Any]) -> dict[str, Any]:
    """Options given as a mapping and by name. Raises PrsError for one given both ways."""
    if twice := (options or {}).keys() & more.keys():
        raise PrsError(f"reducer '{reducer}': option '{min(twice)}' is given twice, by name and in 'options'")
    return {**(options or {}), **more}


def all_interfaces(nodes: Any, interfaces: Any) -> dict[str, Any]:
    """Interfaces given in full or in short, and as nodes only. Raises PrsError for a name in both."""
    at_nodes = {name: _at_nodes(plain(each)) for name, each in _by_name(nodes).items()}
    others = _by_name(interfaces)
    if twice := at_nodes.keys() & others.keys():
        raise PrsError(f"interface '{min(twice)}' is given twice, in 'nodes' and in 'interfaces'")
    return {**at_nodes, **others}


def _by_name(given: Any) -> dict[str, Any]:
    """What is no mapping is called by its own name: ``[3, 11]`` are interfaces ``3`` and ``11``."""
    if given is None:
        return {}
    if isinstance(given, Mapping):
        return {str(name): each for name, each in given.items()}
    each = plain(given)
    return {str(one): one for one in (each if isinstance(each, tuple) else (each,))}


def _at_nodes(value: NodeId | Sequence[NodeId]) -> dict[str, Any]:
    return {"nodes": value} if isinstance(value, tuple) else {"node": value}


def asked(name: str, body: Body, folder: Path) -> tuple[plugins.Reducer[Any], plugins.PartRequest[Any]]:
    """The reducer of a body, and what it is asked for."""
    reducer = plugins.reducer(body.reducer)
    options = validated(reducer.Options, body.options, f"part {name}", ("options",), SI)
    source = _source(body, folder, reducer)
    return reducer, plugins.PartRequest(name, source, options, _file_units(body, source, reducer), body)


def validated(section: type[S], entries: Mapping[str, Any], file: str, place: Place, units: Units) -> S:
    """Entries as a section, in SI. Raises DescriptionError with every problem, placed at `place` in `file`."""
    raw = plain(entries)
    try:
        return section.model_validate(raw, context={"units": units})
    except ValidationError as error:
        problems = Problems(file, {})
        report(error, section, raw, problems, place)
        problems.raise_if_any()
        raise


def plain(value: Any) -> Any:
    """Lists and arrays as tuples, sections as mappings, as the sections' strict validation wants them."""
    if isinstance(value, Section):
        return plain({name: getattr(value, name) for name in value.model_fields_set})
    if isinstance(value, Mapping):
        return {name: plain(each) for name, each in value.items()}
    if isinstance(value, np.ndarray | np.generic):
        return plain(value.tolist())
    if isinstance(value, list | tuple):
        return tuple(map(plain, value))
    return str(value) if isinstance(value, Path) else value


def _source(body: Body, folder: Path, reducer: plugins.Reducer[Any]) -> Path | None:
    place = f"reducer '{body.reducer}'"
    if reducer.needs_source and body.source is None:
        raise PartFileError(place, "found no source, expected the part's file")
    if not reducer.needs_source and body.source is not None:
        raise PartFileError(place, f"found the source '{body.source}', expected none: it reads no file")
    return None if body.source is None else folder / body.source


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
