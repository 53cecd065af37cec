"""The cross checks: what no section can see by itself."""

from __future__ import annotations

from .check_bodies import check_bodies
from .check_joints import check_joints
from .check_names import check_names
from .check_task import check_task
from .check_topology import check_topology
from .check_travel import check_travel
from .problems import not_known
from .subject import Subject


def check(subject: Subject) -> None:
    """Add everything that does not fit together to the subject's problems."""
    check_names(subject)
    check_task(subject)
    check_closures(subject)
    check_bodies(subject)
    check_joints(subject)
    check_topology(subject)
    check_travel(subject)
    check_damping(subject)
    check_output(subject)


def check_closures(subject: Subject) -> None:
    """Closures join two different frames of the URDF."""
    for place, _, closure in subject.each_closure():
        for index, link in enumerate(closure.between):
            subject.check_link((*place, "between", index), link)
        if closure.between[0] == closure.between[1]:
            message = f"found '{closure.between[0]}' twice, expected two different links"
            subject.problems.add((*place, "between"), message)


def check_damping(subject: Subject) -> None:
    """Damping is modal or Rayleigh's, and that of joints is of joints that there are, and is some."""
    damping = subject.file.damping
    if damping.modal is not None and damping.rayleigh is not None:
        subject.problems.add(("damping",), "found modal and rayleigh, expected one of the two; keep one")
    instances = [name for _, name, _ in subject.each_joint()]
    known = dict.fromkeys([*subject.file.joints, *(subject.origins.get(name, name) for name in instances), *instances])
    for name, joint in damping.joints.items():
        place = ("damping", "joints", name)
        if name not in known:
            subject.problems.add(place, not_known("a joint", name, known))
        elif joint.viscous is None and joint.loss_factor is None:
            subject.problems.add(place, "found nothing, expected 'viscous' [s] or 'loss_factor'; add one")


def check_output(subject: Subject) -> None:
    """The output is an interface of a body, and a frame."""
    output = subject.file.output
    subject.check_node(("output", "node"), output.node)
    subject.check_link(("output", "frame"), output.frame)
