"""The machine card: parts, joints, and what the physics gate found, a row for each kind."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..errors import PhysicsError
from ..reduction.summary import Summary, summarize
from ..reduction.travelling import TravellingElement

if TYPE_CHECKING:
    from ..description import schema
    from ..machine import Machine
    from ..reduction import SuperElement
    from ..reduction.gate import Check

    Element = SuperElement | TravellingElement


@dataclass(frozen=True, eq=False)
class Part:
    """One kind of part: how many there are, where it comes from, its figures, and the checks
    that it has passed, none where it failed."""

    name: str
    number: int
    reducer: str
    source: str
    full_dofs: str
    travels: bool
    figures: Summary
    checks: tuple[Check, ...]


@dataclass(frozen=True)
class Joint:
    """One kind of joint: how many, between what, and of what kind its law is."""

    name: str
    number: int
    between: str
    law: str


def parts_of(machine: Machine) -> tuple[tuple[Part, ...], tuple[str, ...]]:
    """The parts, and sentences about what is wrong with any of them or surprising."""
    parts, warnings = [], list[str]()
    stems = machine.description.stems
    names = list(machine.parts)
    for stem in dict.fromkeys(stems[name] for name in names):
        same = [name for name in names if stems[name] == stem]
        part, said = _part(machine, stem, same)
        parts.append(part)
        warnings += said
    return tuple(parts), tuple(warnings)


def joints_of(machine: Machine) -> tuple[Joint, ...]:
    """The elastic joints as described."""
    description = machine.description
    return tuple(
        Joint(
            name,
            sum(stem == name for key, stem in description.stems.items() if key in description.joints),
            " – ".join(joint.between),
            ", ".join(_law(joint)),
        )
        for name, joint in description.file.joints.items()
    )


def moving_mass(machine: Machine) -> float:
    """kg of all parts that are not held to the ground by themselves."""
    free = (_first(part) for part in machine.parts.values())
    return sum(element.mass_properties().mass for element in free if not element.grounded)


def _part(machine: Machine, stem: str, same: list[str]) -> tuple[Part, tuple[str, ...]]:
    element, body = machine.parts[same[0]], machine.description.bodies[same[0]]
    first = _first(element)
    figures = summarize(first, 1)
    checks, failure = _gate(element)
    said = (*(f"part {stem}: {text}" for text in figures.surprises), *failure)
    full = first.provenance.get("full_dofs", "")
    travels = isinstance(element, TravellingElement)
    return Part(stem, len(same), body.reducer, body.source or "", full, travels, figures, checks), said


def _gate(element: Element) -> tuple[tuple[Check, ...], tuple[str, ...]]:
    """The checks passed, at all stations where contacts travel; else the sentence of the one that failed."""
    try:
        found = element.check()
    except PhysicsError as error:
        return (), (f"physics gate: {error}",)
    reports = found if isinstance(found, tuple) else (found,)
    return tuple(check for report in reports for check in report.checks), ()


def _first(element: Element) -> SuperElement:
    return element.elements[0] if isinstance(element, TravellingElement) else element


def _law(joint: schema.Joint) -> Iterator[str]:
    """What holds: so many interfaces, so many stages one after the other, a drive."""
    if joint.interfaces:
        yield f"{len(joint.interfaces)} interfaces in parallel"
    if joint.stages:
        yield f"{len(joint.stages)} stages in series"
    if not joint.interfaces and not joint.stages:
        yield "rigid" if joint.rigid else "elastic"
    if joint.drive is not None:
        yield f"drive: {joint.drive.kind.replace('_', ' ')}"
