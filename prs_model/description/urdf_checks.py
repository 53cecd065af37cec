"""What a URDF's elements must hold. Every check adds a problem and returns something harmless to go on with."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any, Literal, cast, get_args

import numpy as np

from ..errors import Problem
from .problems import did_you_mean, listed, not_known
from .xml_tree import Element

Vector = tuple[float, float, float]
JointKind = Literal["revolute", "continuous", "prismatic", "fixed"]

_NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")

FAR = 50.0  # m; beyond this a placement is taken for millimetres
UNSUPPORTED = {
    "floating": "write it as three prismatic and three revolute joints with massless links between",
    "planar": "write it as two prismatic joints and one revolute joint with massless links between",
}


class Reader:
    """Reads attributes of URDF elements and notes what is wrong with them."""

    def __init__(self, file: str):
        self.file = file
        self.problems: list[Problem] = []

    def add(self, line: int, entry: str, message: str) -> None:
        self.problems.append(Problem(self.file, line, entry, message))

    def name(self, element: Element) -> str:
        name = element.attributes.get("name", "")
        if not name.strip():
            self.add(element.line, f"<{element.tag}>", 'found no name, expected one; add name="..."')
            return ""
        if name != name.strip():
            self.add(element.line, f"{element.tag} '{name}'", "found spaces around the name; remove them")
        elif name == "universe":
            self.add(element.line, f"{element.tag} '{name}'", "the name is taken by Pinocchio; choose another")
        return name

    def kind(self, element: Element, entry: str) -> JointKind:
        kind = element.attributes.get("type", "")
        known = get_args(JointKind)
        if kind in known:
            return cast(JointKind, kind)
        message = f"found type '{kind}', expected one of {listed(known)}"
        advice = f"; {UNSUPPORTED[kind]}" if kind in UNSUPPORTED else did_you_mean(kind, known)
        self.add(element.line, entry, message + advice)
        return "fixed"

    def end(self, element: Element, tag: Literal["parent", "child"]) -> str:
        """The link named by a joint's <parent> or <child>; checked against the links by check_tree."""
        child = element.first(tag)
        return child.attributes.get("link", "") if child is not None else ""

    def origin(self, element: Element, entry: str) -> tuple[Vector, Vector]:
        origin = element.first("origin")
        if origin is None:
            return (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        entry = f"{entry}: origin"
        xyz = self.numbers(origin, "xyz", entry, default=(0.0, 0.0, 0.0))
        rpy = self.numbers(origin, "rpy", entry, default=(0.0, 0.0, 0.0))
        if max(map(abs, xyz)) > FAR:
            found = f"found {max(xyz, key=abs):g} m from the parent frame"
            self.add(origin.line, f"{entry}: xyz", f"{found}, expected metres; this looks like millimetres")
        return xyz, rpy

    def axis(self, element: Element, entry: str) -> Vector:
        axis = element.first("axis")
        if axis is None:
            self.add(element.line, entry, 'found no <axis>, expected one; add <axis xyz="0 0 1"/> or the like')
            return (1.0, 0.0, 0.0)
        x, y, z = self.numbers(axis, "xyz", f"{entry}: axis", default=None)
        length = math.hypot(x, y, z)
        if length < 1e-6:
            self.add(axis.line, f"{entry}: axis", "found a zero axis, expected the direction of motion")
            return (1.0, 0.0, 0.0)
        return x / length, y / length, z / length

    def limits(self, element: Element, entry: str) -> tuple[float, float]:
        limit = element.first("limit")
        if limit is None:
            missing = "found no <limit>, expected lower, upper, effort and velocity; add them (m or rad)"
            self.add(element.line, entry, missing)
            return -math.inf, math.inf
        entry = f"{entry}: limit"
        lower, upper = (self.number(limit, which, entry, -math.inf) for which in ("lower", "upper"))
        for which in ("effort", "velocity"):
            self.number(limit, which, entry, 0.0)
        if math.isfinite(lower) and math.isfinite(upper) and lower >= upper:
            self.add(limit.line, entry, f"found lower {lower:g} and upper {upper:g}, expected lower below upper")
        return lower, upper

    def refuse_mimic(self, element: Element, entry: str) -> None:
        mimic = element.first("mimic")
        if mimic is not None:
            self.add(mimic.line, entry, "found <mimic>, which is not supported; couple the joints by a closure")

    def mass(self, inertial: Element, entry: str) -> float:
        element = inertial.first("mass")
        if element is None:
            self.add(inertial.line, entry, "found <inertial> without <mass>, expected one; a massless link has neither")
            return 1.0
        entry = f"{entry}: mass"
        mass = self.number(element, "value", entry, 1.0)
        if mass <= 0:
            advice = "expected a mass above zero (kg); leave <inertial> out for a massless link"
            self.add(element.line, entry, f"found {mass:g}, {advice}")
        return mass

    def inertia(self, inertial: Element, entry: str) -> tuple[Vector, Vector, Vector]:
        element = inertial.first("inertia")
        unit: tuple[Vector, Vector, Vector] = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
        if element is None:
            self.add(inertial.line, entry, "found <inertial> without <inertia>, expected ixx ixy ixz iyy iyz izz")
            return unit
        entry = f"{entry}: inertia"
        before = len(self.problems)
        xx, xy, xz, yy, yz, zz = (
            self.number(element, key, entry, 0.0) for key in ("ixx", "ixy", "ixz", "iyy", "iyz", "izz")
        )
        if len(self.problems) > before:
            return unit
        matrix = ((xx, xy, xz), (xy, yy, yz), (xz, yz, zz))
        message = inertia_problem(matrix)
        if message:
            self.add(element.line, entry, message)
        return matrix

    def number(self, element: Element, key: str, entry: str, default: float) -> float:
        text = element.attributes.get(key)
        if text is None:
            self.add(element.line, entry, f'found no {key}, expected a number; add {key}="..."')
            return default
        value = _number(text.lstrip(" "))
        if math.isfinite(value):
            return value
        self.add(element.line, entry, f'found {key}="{text}", expected a finite number')
        return default

    def numbers(self, element: Element, key: str, entry: str, default: Vector | None) -> Vector:
        """Three finite numbers; an attribute that is left out is `default`, or a problem where there is none."""
        text = element.attributes.get(key)
        if text is None and default is not None:
            return default
        values = [_number(word) for word in (text or "").split(" ") if word]
        if len(values) == 3 and all(map(math.isfinite, values)):
            return values[0], values[1], values[2]
        found = "nothing" if text is None else f'"{text}"'
        self.add(element.line, f"{entry}: {key}", f"found {found}, expected three finite numbers")
        return default or (1.0, 0.0, 0.0)


def _number(text: str) -> float:
    """A number as Pinocchio reads it; NaN for anything else, such as Python's ``1_0``."""
    return float(text) if _NUMBER.fullmatch(text) else math.nan


def inertia_problem(matrix: tuple[Vector, Vector, Vector]) -> str | None:
    """What makes a matrix impossible as the inertia of a body about its mass centre, or None."""
    moments = np.linalg.eigvalsh(np.array(matrix))
    text = ", ".join(f"{moment:.4g}" for moment in moments)
    if moments[0] <= 0:
        return f"found principal moments {text}, expected all above zero (kg m^2); check signs and decimal places"
    if moments[2] > (moments[0] + moments[1]) * (1 + 1e-4):
        return (
            f"found principal moments {text}, expected the largest at most the sum of the other two, "
            "as in every body; check the order ixx ixy ixz iyy iyz izz and that it is about the mass centre"
        )
    return None


def check_tree(robot: Element, links: Mapping[str, Any], reader: Reader) -> str:
    """Names are unique, joints refer to links, and they form one tree. Returns its root link."""
    before = len(reader.problems)
    if not robot.attributes.get("name"):
        reader.add(robot.line, "<robot>", 'found no name, expected one; add name="..."')
    _check_tags(robot, reader)
    _check_unique(robot, reader)
    if not links:
        reader.add(robot.line, "<robot>", "found no links, expected at least one")
    above: dict[str, Element] = {}
    for joint in robot.all("joint"):
        _check_ends(joint, above, links, reader)
    if len(reader.problems) > before or "" in links:
        return ""
    return _root(robot, links, above, reader)


def _check_tags(robot: Element, reader: Reader) -> None:
    for element in robot.children:
        guess = did_you_mean(element.tag, ("link", "joint")) if element.tag not in ("link", "joint") else ""
        if guess:
            reader.add(element.line, f"<{element.tag}>", f"found an unknown element{guess}")


def _check_unique(robot: Element, reader: Reader) -> None:
    for tag in ("link", "joint"):
        seen: dict[str, int] = {}
        for element in robot.all(tag):
            name = element.attributes.get("name", "")
            if name in seen:
                message = f"found the name a second time (first on line {seen[name]}), expected unique names"
                reader.add(element.line, f"{tag} '{name}'", message)
            elif name:
                seen[name] = element.line


def _check_ends(joint: Element, above: dict[str, Element], links: Mapping[str, Any], reader: Reader) -> None:
    entry = f"joint '{joint.attributes.get('name', '')}'"
    ends = {}
    for tag in ("parent", "child"):
        element = joint.first(tag)
        ends[tag] = element.attributes.get("link", "") if element is not None else ""
        line = element.line if element is not None else joint.line
        if not ends[tag]:
            reader.add(line, entry, f'found no {tag}, expected <{tag} link="..."/>')
        elif ends[tag] not in links:
            reader.add(line, f"{entry}: {tag}", not_known("a link", ends[tag], links))
    child = ends["child"]
    if child and child == ends["parent"]:
        reader.add(joint.line, entry, f"found link '{child}' as parent and child, expected two links")
    elif child in above:
        other = above[child]
        reader.add(
            joint.line,
            entry,
            f"found link '{child}' as its child, which already is the child of joint "
            f"'{other.attributes.get('name', '')}' (line {other.line}), expected one parent a link; cut the loop: "
            "end this chain in a massless link of its own and add a closure in machine.yaml",
        )
    elif child:
        above[child] = joint


def _root(robot: Element, links: Mapping[str, Any], above: Mapping[str, Element], reader: Reader) -> str:
    roots = [name for name in links if name not in above]
    if len(roots) > 1:
        message = f"found {len(roots)} links without a parent ({listed(roots)}), expected one root; join them by joints"
        reader.add(robot.line, "<robot>", message)
        return ""
    reached = {name for name in links if _leads_to_root(name, above)}
    looped = [name for name in links if name not in reached]
    if looped:
        line = min(above[name].line for name in looped)
        found = f"found links that are their own ancestors ({listed(looped)})"
        message = f"{found}, expected a tree; cut the loop and add a closure in machine.yaml"
        reader.add(line, "<robot>", message)
        return ""
    return roots[0]


def _leads_to_root(link: str, above: Mapping[str, Element]) -> bool:
    seen = set()
    while link in above:
        if link in seen:
            return False
        seen.add(link)
        parent = above[link].first("parent")
        link = parent.attributes["link"] if parent is not None else ""
    return True
