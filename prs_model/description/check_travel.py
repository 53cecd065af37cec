"""Interfaces that travel: along a prismatic joint, over all of its stroke, and with the joint that takes hold there."""

from __future__ import annotations

from collections.abc import Iterator

from .check_bodies import interface_place
from .check_task import joint_dimension
from .interface import Travel
from .problems import Place, listed, not_known
from .subject import Subject
from .urdf import SLACK, Urdf, UrdfJoint


def check_travel(subject: Subject) -> None:
    """Check every travelling interface of the machine's bodies."""
    if subject.urdf is None:
        return
    for place, name, body in subject.each_body():
        for interface, content in body.interfaces.items():
            if content.travel is not None:
                where = (*interface_place(subject, place, body, interface), "travel")
                _check_travel(subject, where, content.travel, subject.urdf)
                _check_users(subject, where, content.travel, f"{name}.{interface}")


def _check_travel(subject: Subject, place: Place, travel: Travel, urdf: Urdf) -> None:
    if not any(travel.along):
        subject.problems.add((*place, "along"), "found a zero vector, expected the direction of travel")
    rising = all(a < b for a, b in zip(travel.stations, travel.stations[1:], strict=False))
    if not rising:
        subject.problems.add((*place, "stations"), "found values out of order, expected rising values of the joint")
    joint = urdf.joints.get(travel.joint)
    if joint is None:
        subject.problems.add((*place, "joint"), not_known("a joint of the URDF", travel.joint, urdf.movable))
    elif joint.kind != "prismatic":
        message = f"found '{joint.name}', which is {joint.kind}, expected a prismatic joint"
        subject.problems.add((*place, "joint"), message)
    elif rising:
        _check_stroke(subject, (*place, "stations"), travel.stations, joint)


def _check_stroke(subject: Subject, place: Place, stations: tuple[float, ...], joint: UrdfJoint) -> None:
    dimension, units = joint_dimension(joint), subject.file.units
    factor = dimension.factor(units)
    if stations[0] * factor > joint.lower + SLACK or stations[-1] * factor < joint.upper - SLACK:
        limits = f"{joint.lower / factor:g} .. {joint.upper / factor:g} {dimension.label(units)}"
        message = (
            f"found stations {stations[0]:g} .. {stations[-1]:g} {dimension.label(units)}, expected them to cover the "
            f"limits of '{joint.name}' ({limits}, line {joint.line} of the URDF); add stations or narrow the limits"
        )
        subject.problems.add(place, message)


def _check_users(subject: Subject, place: Place, travel: Travel, interface: str) -> None:
    """The joints that take hold of an interface move with the URDF joint that it travels with.

    Where one of them does and another does not, the other one is in the wrong place.
    """
    users = list(_users(subject, interface))
    agree = any(travel.joint in moving for _, _, moving in users)
    for end, joint, moving in users:
        if not moving or travel.joint in moving:
            continue
        if agree:
            message = (
                f"found '{interface}', which travels with '{travel.joint}', expected an interface "
                f"that travels with {listed(moving)}, as joint '{joint}' does"
            )
            subject.problems.add(end, message)
        else:
            expected = f"expected {listed(moving)}, with which joint '{joint}' moves along '{interface}'"
            message = f"found '{travel.joint}', {expected}"
            subject.problems.add((*place, "joint"), message)


def _users(subject: Subject, interface: str) -> Iterator[tuple[Place, str, list[str]]]:
    """The joints between `interface` (or its members) and something: the end's place, the joint, its URDF joints."""
    movable = subject.urdf.movable if subject.urdf is not None else {}
    for place, name, joint in subject.each_joint():
        moving = [stage.urdf for stage in joint.stages or (joint,) if stage.urdf in movable]
        for index, end in enumerate(joint.between):
            if end == interface or end.startswith(f"{interface}."):
                yield (*place, "between", index), name, [each for each in moving if each is not None]
