"""Small mechanisms written out as machine folders."""

from __future__ import annotations

from collections.abc import Iterable
from math import atan2, cos, pi, sin
from pathlib import Path

import numpy as np

from prs_model.description import load_description
from prs_model.kinematics import Kinematics

Vector = tuple[float, float, float]

MACHINE = """\
name: mechanism
urdf: mechanism.urdf
task:
  kind: {kind}
  frame: {frame}
  relative_to: {relative_to}
  workspace: {{{workspace}}}
  reference:
    pose: {{{pose}}}
    joints: {{{joints}}}
closures: {{{closures}}}
bodies:
{bodies}
joints:
{links}
output: {{node: {frame}.origin, frame: {frame}}}
"""
BODY = (
    "{{frame: {0}, reducer: rigid, options: {{mass: 1.0, nodes: {{origin: [0, 0, 0]}}}}, interfaces: {{origin: {{}}}}}}"
)
JOINT = "{{{0}, between: [{1}.origin, {2}.origin], rigid: true}}"


class Robot:
    """Collects links and joints of a URDF; each link is a body, each joint rigid but for its free axis."""

    def __init__(self, root: str):
        self._links = [root]
        self._joints: list[str] = []
        self.held: list[str] = []

    def add(
        self,
        name: str,
        kind: str,
        parent: str,
        child: str,
        xyz: Vector = (0, 0, 0),
        rpy: Vector = (0, 0, 0),
        axis: Vector = (0, 0, 1),
        limits: tuple[float, float] = (-3.0, 3.0),
    ) -> None:
        self._links.append(child)
        stands_for = f"frame: {child}" if kind == "fixed" else f"urdf: {name}"
        self.held.append(f"  {name}: {JOINT.format(stands_for, parent, child)}")
        numbers = [" ".join(f"{value:.17g}" for value in vector) for vector in (xyz, rpy, axis)]
        limit = f'<limit lower="{limits[0]}" upper="{limits[1]}" effort="1" velocity="1"/>'
        self._joints.append(
            f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin xyz="{numbers[0]}" rpy="{numbers[1]}"/>'
            + (f'<axis xyz="{numbers[2]}"/>' if kind != "fixed" else "")
            + (limit if kind in ("revolute", "prismatic") else "")
            + "</joint>"
        )

    def bodies(self) -> list[str]:
        return [f"  {name}: {BODY.format(name)}" for name in self._links]

    def text(self) -> str:
        links = "".join(f'<link name="{name}"/>' for name in self._links)
        return f'<robot name="mechanism">{links}{"".join(self._joints)}</robot>'


def machine(
    folder: Path,
    robot: Robot,
    *,
    kind: str,
    frame: str,
    pose: dict[str, float],
    joints: dict[str, float],
    closures: Iterable[tuple[str, str, str]] = (),
    relative_to: str = "base",
) -> Kinematics:
    """Write the folder and load its kinematics; closures are (a, b, kind)."""
    (folder / "mechanism.urdf").write_text(robot.text())
    (folder / "machine.yaml").write_text(
        MACHINE.format(
            kind=kind,
            frame=frame,
            relative_to=relative_to,
            bodies="\n".join(robot.bodies()),
            links="\n".join(robot.held),
            workspace=", ".join(f"{name}: [{value - 10}, {value + 10}]" for name, value in pose.items()),
            pose=", ".join(f"{name}: {value!r}" for name, value in pose.items()),
            joints=", ".join(f"{name}: {value!r}" for name, value in joints.items()),
            closures=", ".join(
                f"loop_{i}: {{between: [{a}, {b}], kind: {loop}}}" for i, (a, b, loop) in enumerate(closures, 2)
            ),
        )
    )
    return Kinematics(load_description(folder))


# ── planar 3-RRR ─────────────────────────────────────────────────────────────────────────────────────

GROUND, PLATE, LINK = 0.5, 0.15, 0.35  # radii of base and platform joints, length of both links of a leg [m]


def planar_3rrr(folder: Path, *, loop: str = "frame", turn: str = "continuous", kind: str = "planar") -> Kinematics:
    """A 3-RRR mechanism in a tilted plane, measured in that plane. ``point`` loops have no last joint of their own."""
    robot = Robot("base")
    robot.add("plane_mount", "fixed", "base", "plane", (0.1, -0.2, 0.3), (0.3, -0.4, 0.5))
    closures, joints = [], {}
    for leg, direction in enumerate((-pi / 2, pi / 6, 5 * pi / 6), 1):
        anchor = (GROUND * cos(direction), GROUND * sin(direction), 0.0)
        robot.add(f"a_{leg}", turn, "plane", f"crank_{leg}", anchor)
        robot.add(f"b_{leg}", turn, f"crank_{leg}", f"coupler_{leg}", (LINK, 0, 0))
        first, second = _elbow(direction)
        joints |= {f"a_{leg}": first, f"b_{leg}": second}
        if leg == 1 or loop == "frame":
            robot.add(f"c_{leg}", turn, f"coupler_{leg}", f"end_{leg}", (LINK, 0, 0))
            joints[f"c_{leg}"] = direction - first - second
        else:
            robot.add(f"end_{leg}_mount", "fixed", f"coupler_{leg}", f"end_{leg}", (LINK, 0, 0))
        if leg == 1:  # its last frame points outwards along the leg's direction
            robot.add("plate_mount", "fixed", "end_1", "plate", (-PLATE, 0, 0), (0, 0, pi / 2))
        seat = (PLATE * cos(direction), PLATE * sin(direction), 0.0)
        robot.add(f"seat_{leg}_mount", "fixed", "plate", f"seat_{leg}", seat, (0, 0, direction))
        if leg > 1:
            closures.append((f"end_{leg}", f"seat_{leg}", loop))
    pose = {"x": 0.0, "y": 0.0, "phi": 0.0} if kind == "planar" else {"x": 0.1, "y": -0.2, "z": 0.3}
    relative_to = "plane" if kind == "planar" else "base"
    return machine(
        folder, robot, kind=kind, frame="plate", pose=pose, joints=joints, closures=closures, relative_to=relative_to
    )


def _elbow(direction: float) -> tuple[float, float]:
    """Crank and coupler angle of a leg at the centred pose, elbow to the left of the way in."""
    reach = GROUND - PLATE
    lift = float(atan2((LINK**2 - (reach / 2) ** 2) ** 0.5, reach / 2))
    return direction + pi + lift - 2 * pi * (direction + pi + lift > pi), -2 * lift


def crank_angles(poses: np.ndarray) -> np.ndarray:
    """Angle of crank 2 at poses (N, 3), from the law of cosines."""
    direction = np.pi / 6
    tip = poses[:, :2] + PLATE * np.column_stack([np.cos(direction + poses[:, 2]), np.sin(direction + poses[:, 2])])
    way = tip - GROUND * np.array([np.cos(direction), np.sin(direction)])
    lift = np.arccos(np.linalg.norm(way, axis=1) / (2 * LINK))
    angle = np.arctan2(way[:, 1], way[:, 0]) + lift
    return np.arctan2(np.sin(angle), np.cos(angle))
