"""Elastic joints against the URDF: each stands for the URDF joints that lead from one of its ends to the other.

Links that do not move against each other (fixed joints, ``frame`` closures) count as one piece.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from .laws import leaves_free
from .problems import Place, dotted, listed
from .schema import Joint, MachineFile, Stage
from .subject import Subject
from .urdf import Urdf, UrdfJoint

Step = tuple[Place, UrdfJoint]
"""A URDF joint that moves, and the place of the entry that names it."""


@dataclass(frozen=True)
class Pieces:
    """The piece each link belongs to, named by one of its links; and the pairs of pieces a ``point`` closure joins."""

    of: dict[str, str]
    hinged: set[frozenset[str]]

    def same(self, a: str, b: str) -> bool:
        return self.of[a] == self.of[b]


def check_topology(subject: Subject) -> None:
    """Check that every URDF joint that moves is held by one joint, and that this one is between its two sides."""
    if subject.urdf is None or not _closures_are_sound(subject):
        return
    pieces = _pieces(subject, subject.urdf)
    held: dict[str, tuple[Place, str]] = {}
    for place, name, joint in subject.each_joint():
        steps = list(_steps(place, joint, subject.urdf))
        new = _hold(subject, name, steps, held)
        ends = _end_links(subject, joint, subject.urdf)
        if not new or ends is None:
            continue
        if steps:
            _check_way(subject, place, joint, steps, ends, pieces)
        else:
            _check_at_rest(subject, place, joint, ends, pieces)
        if steps or pieces.same(*ends):
            _check_frames(subject, place, joint, {*ends, *_links(steps)}, pieces)
    idle = [name for name in subject.urdf.movable if name not in held]
    if idle and not subject.problems.touches(("joints",)):
        message = f"found no entry that holds {listed(idle)} of the URDF, expected one for every joint that moves"
        subject.problems.add(("joints",), f"{message}; add it, or make the URDF's joint fixed")


def _closures_are_sound(subject: Subject) -> bool:
    """Whether all closures are known: none has a problem, and no misspelt section may stand for them."""
    return not subject.problems.touches(("closures",)) and set(subject.raw) <= set(MachineFile.model_fields)


def _pieces(subject: Subject, urdf: Urdf) -> Pieces:
    closures = [closure for _, _, closure in subject.each_closure()]
    joined = [(joint.parent, joint.child) for joint in urdf.joints.values() if joint.kind == "fixed"]
    joined += [closure.between for closure in closures if closure.kind == "frame"]
    of = {link: link for link in urdf.links}
    for a, b in joined:
        kept, absorbed = of[a], of[b]
        of = {link: kept if piece == absorbed else piece for link, piece in of.items()}
    points = [closure.between for closure in closures if closure.kind == "point"]
    return Pieces(of, {frozenset((of[a], of[b])) for a, b in points})


def _stages(place: Place, joint: Joint) -> Iterator[tuple[Place, Stage]]:
    if not joint.stages:
        yield place, joint
    for index, stage in enumerate(joint.stages):
        yield (*place, "stages", index), stage


def _steps(place: Place, joint: Joint, urdf: Urdf) -> Iterator[Step]:
    for where, stage in _stages(place, joint):
        if stage.urdf in urdf.movable:
            yield (*where, "urdf"), urdf.joints[stage.urdf]


def _links(steps: Sequence[Step]) -> Iterator[str]:
    for _, joint in steps:
        yield from (joint.parent, joint.child)


def _end_links(subject: Subject, joint: Joint, urdf: Urdf) -> tuple[str, str] | None:
    """The links of a joint's two ends; None where one of them is not known, or a URDF joint of the entry is not."""
    if any(stage.urdf is not None and stage.urdf not in urdf.joints for _, stage in _stages((), joint)):
        return None
    names = [end.partition(".")[0] for end in joint.between]
    links = [urdf.root if name == "ground" else _frame(subject, name) for name in names]
    return (links[0], links[1]) if all(link in urdf.links for link in links) else None


def _frame(subject: Subject, body: str) -> str:
    return subject.bodies[body].frame if body in subject.bodies else ""


def _hold(subject: Subject, name: str, steps: Sequence[Step], held: dict[str, tuple[Place, str]]) -> bool:
    """Add a joint's URDF joints to those that are held; whether all of them are new there."""
    new = True
    for place, joint in steps:
        if joint.name in held:
            first, holder = held[joint.name]
            found = f"found '{joint.name}' a second time (first for joint '{holder}' in {dotted(first)})"
            subject.problems.add(place, f"{found}, expected every URDF joint in one place; correct or remove one")
            new = False
        else:
            held[joint.name] = (place, name)
    return new


def _check_way(
    subject: Subject, place: Place, joint: Joint, steps: Sequence[Step], ends: tuple[str, str], pieces: Pieces
) -> None:
    """The URDF joints lead from one end to the other, in the order of the stages or against it.

    Otherwise the longest way from an end tells what is wrong: the other end, or the URDF joint where it stops.
    """
    ways = [(start, *_way(ends[start], order, pieces)) for order in (steps, steps[::-1]) for start in (0, 1)]
    if any(not rest and pieces.same(last, ends[1 - start]) for start, last, rest in ways):
        return
    start, last, rest = min(ways, key=lambda way: len(way[2]))
    if rest:
        where, stop = rest[0]
        found = f"found '{stop.name}', which is between links '{stop.parent}' and '{stop.child}'"
        ends_of = f"joint between links '{ends[0]}' and '{ends[1]}'"
        expected = f"expected one that leads on from link '{last}', for a {ends_of}"
        subject.problems.add(where, f"{found}, {expected}; correct it, or the ends of the joint")
        return
    led = f"where {listed(each.name for _, each in steps)} leads from '{joint.between[start]}'"
    message = f"found '{joint.between[1 - start]}' on link '{ends[1 - start]}', expected an end on link '{last}', {led}"
    advice = "; correct the end, the URDF joint, or the frame of the body"
    subject.problems.add((*place, "between", 1 - start), message + advice)


def _way(start: str, steps: Sequence[Step], pieces: Pieces) -> tuple[str, Sequence[Step]]:
    """The link to which the URDF joints lead from `start`, one after the other; and those that do not go on from it."""
    link = start
    for count, (_, joint) in enumerate(steps):
        if pieces.same(link, joint.parent):
            link = joint.child
        elif pieces.same(link, joint.child):
            link = joint.parent
        else:
            return link, steps[count:]
    return link, ()


def _check_at_rest(subject: Subject, place: Place, joint: Joint, ends: tuple[str, str], pieces: Pieces) -> None:
    """Without a URDF joint the ends are one piece, or meet in a ``point`` closure, or are left free to move."""
    if pieces.same(*ends) or frozenset(pieces.of[end] for end in ends) in pieces.hinged:
        return
    if any(leaves_free(stage) for _, stage in _stages(place, joint)):
        return
    message = (
        f"found ends on links '{ends[0]}' and '{ends[1]}', which move against each other, and a joint that holds all "
        "directions; name the URDF joint in between with 'urdf', or give zero stiffness where the ends are to move"
    )
    subject.problems.add((*place, "between"), message)


def _check_frames(subject: Subject, place: Place, joint: Joint, links: set[str], pieces: Pieces) -> None:
    """A frame in which stiffness is given belongs to what the joint is between."""
    for where, stage in _stages(place, joint):
        frame = stage.frame
        if frame in pieces.of and not any(pieces.same(frame, link) for link in links):
            known = listed(sorted(link for link in pieces.of if any(pieces.same(link, each) for each in links)))
            message = f"found '{frame}', which moves against both ends, expected a link of either ({known})"
            subject.problems.add((*where, "frame"), message)
