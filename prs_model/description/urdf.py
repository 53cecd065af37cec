"""Reading a URDF: links, joints and what they weigh, checked before Pinocchio sees the file.

Pinocchio takes a missing axis, a negative mass or a loop without a useful word; all of that is caught here, everything
at once and with line numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from ..errors import DescriptionError, Problem, UnknownNameError
from .problems import did_you_mean
from .urdf_checks import JointKind, Reader, Vector, check_tree
from .xml_tree import Element, XmlError, parse_xml

SLACK = 1e-9  # m or rad; limits that differ by less are the same


@dataclass(frozen=True)
class Inertial:
    """Mass [kg], its centre and axes in the link frame [m, rad], inertia about the centre in those axes [kg m^2]."""

    mass: float
    xyz: Vector
    rpy: Vector
    inertia: tuple[Vector, Vector, Vector]


@dataclass(frozen=True)
class UrdfLink:
    """A rigid body; a massless one has no inertial."""

    name: str
    inertial: Inertial | None
    line: int


@dataclass(frozen=True)
class UrdfJoint:
    """A joint; its frame is the frame of its child link. Axis of unit length, limits in m or rad."""

    name: str
    kind: JointKind
    parent: str
    child: str
    xyz: Vector
    rpy: Vector
    axis: Vector
    lower: float
    upper: float
    line: int

    @property
    def is_rotary(self) -> bool:
        return self.kind in ("revolute", "continuous")

    @property
    def free_axis(self) -> str | None:
        """``ux`` .. ``rz``: the motion of the joint in its own frame; None if fixed or along no coordinate axis."""
        if self.kind == "fixed":
            return None
        for letter, component in zip("xyz", self.axis, strict=True):
            if abs(abs(component) - 1.0) < 1e-9:
                return ("r" if self.is_rotary else "u") + letter
        return None


@dataclass(frozen=True)
class Urdf:
    """The open tree of a machine."""

    path: Path
    name: str
    root: str
    links: Mapping[str, UrdfLink]
    joints: Mapping[str, UrdfJoint]

    @property
    def movable(self) -> dict[str, UrdfJoint]:
        """The joints that have a value, in the order of the file."""
        return {name: joint for name, joint in self.joints.items() if joint.kind != "fixed"}

    def joint(self, name: str) -> UrdfJoint:
        """The joint of that name. Raises UnknownNameError with a did-you-mean."""
        if name not in self.joints:
            hint = did_you_mean(name, self.joints).lstrip("; ").capitalize()
            raise UnknownNameError("joint of the URDF", name, tuple(self.joints), hint)
        return self.joints[name]


def read_urdf(path: Path | str) -> Urdf:
    """Read and check a URDF file.

    Raises DescriptionError that lists every problem found, each with its line: syntax, names, references, loops,
    joint types, axes, limits, masses and inertias.
    """
    path = Path(path)
    reader = Reader(path.name)
    robot = _robot(path)
    links = {link.name: link for link in _links(robot, reader)}
    joints = {joint.name: joint for joint in _joints(robot, reader)}
    root = check_tree(robot, links, reader)
    if reader.problems:
        raise DescriptionError(sorted(reader.problems, key=lambda problem: problem.line or 0))
    return Urdf(path, robot.attributes["name"], root, links, joints)


def _robot(path: Path) -> Element:
    def refuse(line: int | None, message: str) -> DescriptionError:
        return DescriptionError([Problem(path.name, line, "", message)])

    try:
        root = parse_xml(path.read_bytes())
    except OSError as error:
        raise refuse(None, f"cannot be read: {error.strerror}") from error
    except XmlError as error:
        raise refuse(error.line, error.message) from error
    if root.tag != "robot":
        raise refuse(root.line, f"found <{root.tag}>, expected <robot> as the outermost element of a URDF")
    return root


def _links(robot: Element, reader: Reader) -> Iterator[UrdfLink]:
    for element in robot.all("link"):
        yield UrdfLink(reader.name(element), _inertial(element, reader), element.line)


def _inertial(link: Element, reader: Reader) -> Inertial | None:
    element = link.first("inertial")
    if element is None:
        return None
    entry = f"link '{link.attributes.get('name', '')}'"
    xyz, rpy = reader.origin(element, entry)
    return Inertial(reader.mass(element, entry), xyz, rpy, reader.inertia(element, entry))


def _joints(robot: Element, reader: Reader) -> Iterator[UrdfJoint]:
    for element in robot.all("joint"):
        name = reader.name(element)
        entry = f"joint '{name}'"
        kind = reader.kind(element, entry)
        xyz, rpy = reader.origin(element, entry)
        reader.refuse_mimic(element, entry)
        axis = reader.axis(element, entry) if kind != "fixed" else (1.0, 0.0, 0.0)
        bounded = kind in ("revolute", "prismatic")
        lower, upper = reader.limits(element, entry) if bounded else (-math.inf, math.inf)
        yield UrdfJoint(
            name,
            kind,
            reader.end(element, "parent"),
            reader.end(element, "child"),
            xyz,
            rpy,
            axis,
            lower,
            upper,
            element.line,
        )
