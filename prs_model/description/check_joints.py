"""Elastic joints: what they are between, the URDF joint they stand for, their laws and drives."""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence

from .laws import LAWS, check_law, check_one_of
from .problems import Place, listed, not_known
from .schema import BallScrew, ConstantDrive, Drive, Interface, Joint, Stage
from .subject import Subject
from .urdf import SLACK, UrdfJoint


def check_joints(subject: Subject) -> None:
    """Check every elastic joint of the machine."""
    for place, _, joint in subject.each_joint():
        _check_ends(subject, place, joint)
        _check_interface_names(subject, place, joint)
        if check_one_of(subject.problems, place, joint, (*LAWS, "interfaces", "stages")) and joint.stages:
            _check_stages(subject, place, joint)
        elif not joint.stages:
            _check_stage(subject, place, joint)
        if joint.as_printed and not joint.stages:
            subject.problems.add((*place, "as_printed"), "found true, expected it only with 'stages'; remove it")


def _check_ends(subject: Subject, place: Place, joint: Joint) -> None:
    for index, end in enumerate(joint.between):
        subject.check_end((*place, "between", index), end)
    if joint.between[0] == joint.between[1]:
        message = f"found '{joint.between[0]}' twice, expected two different ends"
        subject.problems.add((*place, "between"), message)


def _check_stages(subject: Subject, place: Place, joint: Joint) -> None:
    for key in ("urdf", "frame", "drive"):
        if getattr(joint, key) is not None:
            subject.problems.add((*place, key), "found an entry beside 'stages', expected it inside one of the stages")
    for index, stage in enumerate(joint.stages):
        where = (*place, "stages", index)
        check_one_of(subject.problems, where, stage, (*LAWS, "interfaces"))
        _check_stage(subject, where, stage)


def _check_stage(subject: Subject, place: Place, stage: Stage) -> None:
    if not check_one_of(subject.problems, place, stage, ("urdf", "frame")):
        return
    if stage.frame is not None:
        subject.check_link((*place, "frame"), stage.frame)
    moving = _urdf_joint(subject, place, stage)
    if subject.urdf is None or subject.problems.touches((*place, "urdf")):
        return
    check_law(subject.problems, place, stage, moving)
    for index, interface in enumerate(stage.interfaces):
        where = (*place, "interfaces", index)
        if check_one_of(subject.problems, where, interface, LAWS):
            check_law(subject.problems, where, interface, moving)
    if stage.drive is not None:
        _check_drive(subject, (*place, "drive"), stage.drive, moving)


def _urdf_joint(subject: Subject, place: Place, stage: Stage) -> UrdfJoint | None:
    """The URDF joint of a stage if it moves; None for a fixed one or a plain frame."""
    if stage.urdf is None or subject.urdf is None:
        return None
    joint = subject.urdf.joints.get(stage.urdf)
    if joint is None:
        message = not_known("a joint of the URDF", stage.urdf, subject.urdf.joints)
        subject.problems.add((*place, "urdf"), message)
    elif joint.kind != "fixed" and joint.free_axis is None:
        axis = " ".join(f"{component:.4g}" for component in joint.axis)
        message = (
            f"found '{joint.name}' with axis {axis} in {subject.urdf.path.name}:{joint.line}, expected a coordinate "
            "axis of its frame, on which stiffnesses are given; turn the joint's origin (rpy) so that it is one"
        )
        subject.problems.add((*place, "urdf"), message)
    elif joint.kind != "fixed":
        return joint
    return None


def _check_interface_names(subject: Subject, place: Place, joint: Joint) -> None:
    """Interfaces of the joint must be members of its ends, where those have members."""
    members = {
        end: [m.name for m in interface.members] for end, interface in _ends(subject, joint) if interface.members
    }
    known = [name for names in members.values() for name in names]
    seen: set[str] = set()
    for index, interface in enumerate(joint.interfaces):
        where = (*place, "interfaces", index)
        if not interface.name:
            if known or interface.name == "":
                message = f"found no name, expected one of the members it may act on ({listed(dict.fromkeys(known))})"
                subject.problems.add((*where, "name"), message)
        elif interface.name in seen:
            message = f"found '{interface.name}' a second time, expected a name of its own for every interface"
            subject.problems.add((*where, "name"), message)
        elif known and interface.name not in known:
            what = f"a member of {' or '.join(members)}"
            subject.problems.add((*where, "name"), not_known(what, interface.name, dict.fromkeys(known)))
        seen.add(interface.name or "")
    if joint.interfaces and not subject.problems.touches((*place, "interfaces")):
        _check_members_held(subject, (*place, "interfaces"), members, seen)


def _check_members_held(
    subject: Subject, place: Place, members: Mapping[str, Sequence[str]], named: Collection[str]
) -> None:
    for end, names in members.items():
        idle = [name for name in names if name not in named]
        if idle:
            found = f"found none for {listed(idle)} of '{end}', which would carry nothing"
            subject.problems.add(place, f"{found}, expected one for every member; add it, or leave the member out")


def _ends(subject: Subject, joint: Joint) -> Iterator[tuple[str, Interface]]:
    for end in joint.between:
        body, _, name = end.partition(".")
        if body in subject.bodies and name in subject.bodies[body].interfaces:
            yield end, subject.bodies[body].interfaces[name]


def _check_drive(subject: Subject, place: Place, drive: Drive, joint: UrdfJoint | None) -> None:
    if joint is None:
        subject.problems.add(place, "found a drive, expected it only on a URDF joint that moves; use 'urdf'")
    elif isinstance(drive, ConstantDrive):
        _check_constant(subject, place, drive, joint)
    elif joint.kind != "prismatic":
        message = f"found a ball screw on '{joint.name}', which is {joint.kind}, expected a prismatic joint"
        subject.problems.add(place, message)
    else:
        _check_screw(subject, place, drive, joint)


def _check_constant(subject: Subject, place: Place, drive: ConstantDrive, joint: UrdfJoint) -> None:
    if not check_one_of(subject.problems, place, drive, ("stiffness", "rotational_stiffness")):
        return
    fitting, other = ("stiffness", "rotational_stiffness")[:: -1 if joint.is_rotary else 1]
    if getattr(drive, fitting) is None:
        message = f"found {other}, expected {fitting}; '{joint.name}' is {joint.kind}"
        subject.problems.add((*place, other), message)


def _check_screw(subject: Subject, place: Place, drive: BallScrew, joint: UrdfJoint) -> None:
    end = drive.origin + drive.length
    if joint.lower < drive.origin - SLACK or joint.upper > end + SLACK:
        message = (
            f"found a screw for joint values {drive.origin:.4g} .. {end:.4g} m, expected the "
            f"limits of '{joint.name}' ({joint.lower:.4g} .. {joint.upper:.4g} m) within; correct 'origin' or 'length'"
        )
        subject.problems.add(place, message)
