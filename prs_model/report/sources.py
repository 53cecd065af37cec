"""Where every number of a machine description comes from, entry by entry."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from math import isinf
from typing import Any, get_args

from .. import plugins
from ..description import MachineDescription
from ..description.quantity import Quantity
from ..description.section import Section
from ..description.units import Dimension, Units

_PLAIN = Dimension()


@dataclass(frozen=True)
class Entry:
    """One number, or a few that belong together, as written: its place, unit, and source if that is said."""

    place: str
    value: str
    unit: str
    source: str
    note: str


@dataclass(frozen=True)
class _Said:
    """What sections around a number say of it."""

    dimension: Dimension = _PLAIN
    source: str = ""
    note: str = ""


def entries(description: MachineDescription) -> tuple[Entry, ...]:
    """The numbers of parts' options, joints and damping, in the units of the file."""
    file, found = description.file, list[Entry]()
    for name, body in file.bodies.items():
        options = plugins.reducer(body.reducer).Options.model_validate(body.options, context={"units": file.units})
        found += _walk(f"bodies.{name}.options", options, file.units, _Said())
    for name, joint in file.joints.items():
        found += _walk(f"joints.{name}", joint, file.units, _Said())
    found += _walk("damping", file.damping, file.units, _Said())
    return tuple(found)


def _walk(place: str, value: Any, units: Units, said: _Said) -> Iterator[Entry]:
    if isinstance(value, Section):
        yield from _section(place, value, units, said)
    elif isinstance(value, Mapping):
        for name, item in value.items():
            yield from _walk(f"{place}.{name}", item, units, said)
    elif _numbers(value):
        yield _entry(place, value if isinstance(value, tuple) else (value,), units, said)
    elif isinstance(value, tuple) and value and all(map(_numbers, value)):
        yield Entry(place, f"{len(value)} x {len(value[0])} matrix", "", said.source, said.note)
    elif isinstance(value, tuple):
        for number, item in enumerate(value, start=1):
            yield from _walk(f"{place}.{getattr(item, 'name', None) or number}", item, units, said)


def _section(place: str, section: Section, units: Units, said: _Said) -> Iterator[Entry]:
    source = getattr(section, "source", None) or said.source
    note = getattr(section, "note", None) or said.note
    for name, field in type(section).model_fields.items():
        dimension = next(_dimensions([*field.metadata, field.annotation]), _PLAIN)
        value = getattr(section, name)
        if name == "rigid" and value is True:
            yield Entry(place, "rigid", "", source, note)
        elif name not in ("source", "note"):
            yield from _walk(f"{place}.{name}", value, units, _Said(dimension, source, note))


def _numbers(value: Any) -> bool:
    """Whether it is a number with a unit, or a row of them."""
    return isinstance(value, Quantity) or (
        isinstance(value, tuple) and bool(value) and all(isinstance(each, Quantity) for each in value)
    )


def _entry(place: str, values: tuple[Quantity, ...], units: Units, said: _Said) -> Entry:
    factor, label = said.dimension.factor(units), said.dimension.label(units)
    shown = ", ".join("rigid" if isinf(value) else f"{value / factor:.6g}" for value in values)
    source = next((value.source for value in values if value.source), said.source)
    note = next((value.note for value in values if value.note), said.note)
    return Entry(place, shown, "" if said.dimension == _PLAIN else label, source, note)


def _dimensions(annotations: Any) -> Iterator[Dimension]:
    """The dimensions that annotations carry, however deep."""
    for each in annotations:
        if isinstance(found := getattr(each, "dimension", None), Dimension):
            yield found
        yield from _dimensions(get_args(each))
