"""The five parts of the head as solids: one function a part, millimetres, in the part's URDF frame.

Each part is symmetric to the limb's plane; base and platform are so three times. Half a part (or a sixth) is
modelled and meshed with gmsh's OpenCASCADE kernel and then copied, so that the meshes have the symmetry exactly.
`size` multiplies every element length; 1 gives about 3.1e5 degrees of freedom in the assembly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from math import log2
from types import ModuleType

import numpy as np

from prs_model.arrays import BoolArray, FloatArray

from .gmsh_solids import (
    Entity,
    box,
    cut,
    cylinder,
    join,
    keep_half,
    keep_sixth,
    mesh,
    model,
    only,
    prism,
    ring,
    turned_box,
)
from .solid_mesh import SolidMesh, Where, merged, mirrored, rotated, turned

LIMB_ANGLES = (-90.0, 30.0, 150.0)  # degrees; limb 1 points to -y

ROD_LENGTH = 350.0
RAIL_RADIUS = 330.0
SOCKET_RADIUS = 165.0
TOOL_HEIGHT = 315.0

BEARING_RADIUS = 24.0  # where R-joint bearing rings of slider and rod meet
BEARING_SPAN = (45.0, 75.0)
BALL_RADIUS = 26.0  # stands for the S joint's shafts: rod end and platform socket meet on it
CONTACT = 84.0  # carriage and rail meet here (x of the slider frame)
CARRIAGE_Y, CARRIAGE_Z = 80.0, 62.5  # carriage centres
CARRIAGE_HALF = (20.0, 31.25)  # half width and half length of a carriage's contact
RAILS = (400.0, 1000.0)  # from .. to, along z
SEAT = 138.0  # back of the board, where it is bolted to the base (x of the board frame)


def _both_halves(half: SolidMesh) -> SolidMesh:
    return merged([half, mirrored(half)])


def _three_limbs(sixth: SolidMesh) -> SolidMesh:
    third = _both_halves(sixth)
    return merged([rotated(third, angle) for angle in LIMB_ANGLES])


# ── surfaces, by where their nodes are ───────────────────────────────────────────────────────────────


def _near(values: FloatArray, value: float) -> BoolArray:
    return np.abs(values - value) < 0.05


def _within(values: FloatArray, low: float, high: float) -> BoolArray:
    return (values > low - 0.05) & (values < high + 0.05)


def _plane(axis: int, value: float) -> Where:
    return lambda p: _near(p[:, axis], value)


def _bore(side: int) -> Where:
    """The R joint's bearing seat on one side (y < 0: -1, y > 0: +1)."""
    return lambda p: _near(np.hypot(p[:, 0], p[:, 2]), BEARING_RADIUS) & _within(side * p[:, 1], *BEARING_SPAN)


def _ball(centre: Sequence[float]) -> Where:
    return lambda p: _near(np.linalg.norm(p - np.asarray(centre), axis=1), BALL_RADIUS)


def _in_limb(angle: float, where: Where) -> Where:
    """The test applied in the axes of the limb that stands at `angle` degrees."""
    return lambda p: where(turned(p, -angle))


# ── the parts ────────────────────────────────────────────────────────────────────────────────────────


def base(size: float = 1.0) -> SolidMesh:
    """A welded drum round the limbs, with a box column and two bolted strips for each board.

    The drum is closed by a ribbed rear plate and a front plate, and stands on three radial walls that meet in a hub.
    Steel. Frame `base`. Surfaces: `foot` (clamped, z = 0) and `seat_1` .. `seat_3`.
    """
    inner = RAIL_RADIUS + SEAT
    low, high = RAILS
    rear, front = low - 60, high + 20
    with model("base", 92 * size) as gmsh:
        column = [
            box(gmsh, (inner, inner + 8), (60, 100), (low, high)),  # bolted strip
            box(gmsh, (inner + 4, inner + 12), (-112, 112), (rear, front)),  # face of the column
            box(gmsh, (inner + 10, 540), (75, 85), (rear, front)),  # side wall
            box(gmsh, (0, 544), (-18, 18), (rear, low - 5)),  # rib on the rear plate
            box(gmsh, (inner + 10, 540), (-9, 9), (rear, low + 120)),  # middle wall
            box(gmsh, (0, 544), (-25, 25), (10, rear + 5)),  # radial wall that carries the drum
            box(gmsh, (0, 556), (-60, 60), (0, 20)),  # foot
            turned_box(gmsh, 60, (240, 544), (-16, 16), (5, rear + 5)),  # radial wall between two limbs
        ]
        drum = [
            ring(gmsh, (534, 546), (rear, front)),  # shell
            ring(gmsh, (400, 544), (front - 9, front)),  # front plate
            ring(gmsh, (150, 544), (rear, rear + 28)),  # rear plate
            ring(gmsh, (290, 304), (rear - 45, rear + 5)),  # stiffener under it
            cylinder(gmsh, "z", 60, (0, rear + 28)),  # hub
            ring(gmsh, (500, 546), (0, 10)),  # foot ring
        ]
        keep_sixth(gmsh, join(gmsh, column + drum))
        sixth = mesh(gmsh)
    strip = _plane(0, inner)
    seats = {f"seat_{i + 1}": _in_limb(angle, strip) for i, angle in enumerate(LIMB_ANGLES)}
    return _three_limbs(sixth).named({"foot": _plane(2, 0.0), **seats})


def board(size: float = 1.0) -> SolidMesh:
    """A plate with two rails in front and two bolted strips behind, meshed alike all along the travel.

    Steel. Frame `board_i`. Surfaces: `rail_left` (y < 0), `rail_right` and `seat`. The element length along z
    divides 25 mm, so that contacts 100 mm apart take hold of congruent facets.
    """
    outline = [
        (112, 0), (112, 68.5), (CONTACT, 68.5), (CONTACT, 91.5), (112, 91.5), (112, 115),
        (130, 115), (130, 100), (SEAT, 100), (SEAT, 60), (130, 60), (130, 0),
    ]  # fmt: skip
    layers = 24 * 2 ** max(0, round(log2(2 / size)))
    with model("board", 30 * size) as gmsh:
        occ = gmsh.model.occ
        corners = [occ.addPoint(x, y, RAILS[0]) for x, y in outline]
        lines = [occ.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
        section = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        occ.extrude([(2, section)], 0, 0, RAILS[1] - RAILS[0], numElements=[layers])
        half = mesh(gmsh)
    rail = _plane(0, CONTACT)
    return _both_halves(half).named(
        {
            "rail_left": lambda p: rail(p) & (p[:, 1] < 0),
            "rail_right": lambda p: rail(p) & (p[:, 1] > 0),
            "seat": _plane(0, SEAT),
        }
    )


def slider(size: float = 1.0) -> SolidMesh:
    """A plate on four carriages with two lugs that hold the outer rings of the R joint's bearings.

    Steel. Frame `slider_i`. Surfaces: `c1` .. `c4` (carriages at -y -z, +y -z, -y +z, +y +z) and `b1`, `b2`.
    """
    half_width, half_length = CARRIAGE_HALF
    y = (CARRIAGE_Y - half_width, CARRIAGE_Y + half_width)
    with model("slider", 20 * size) as gmsh:
        blocks = [box(gmsh, (60, CONTACT), y, (z - half_length, z + half_length)) for z in (-CARRIAGE_Z, CARRIAGE_Z)]
        lug = [
            box(gmsh, (0, 45), BEARING_SPAN, (-38, 38)),
            cylinder(gmsh, "y", 38, BEARING_SPAN),
        ]
        plate = box(gmsh, (38, 72), (0, 112), (-115, 115))
        cut(gmsh, [join(gmsh, [plate, *lug, *blocks])], [cylinder(gmsh, "y", BEARING_RADIUS, (0, 200))])
        half = mesh(gmsh)

    def carriage(side_y: int, side_z: int) -> Where:
        return lambda p: _near(p[:, 0], CONTACT) & (side_y * p[:, 1] > 0) & (side_z * p[:, 2] > 0)

    return _both_halves(half).named(
        {
            "c1": carriage(-1, -1),
            "c2": carriage(1, -1),
            "c3": carriage(-1, 1),
            "c4": carriage(1, 1),
            "b1": _bore(-1),
            "b2": _bore(1),
        }
    )


def rod(size: float = 1.0) -> SolidMesh:
    """A hub with two journals for the R joint's bearings and a flat bar that ends in the ball of the S joint.

    Steel. Frame `rod_i`. Surfaces: `b1` (y < 0), `b2` and `tip`.
    """
    with model("rod", 24 * size) as gmsh:
        bar = _tapered_bar(gmsh, ((44, 8.4, 43), (100, 8.2, 70), (338, 7.4, 25)))
        neck = box(gmsh, (-20, 20), (-43, 43), (0, 60))  # passes between the slider's lugs
        hub = [
            cylinder(gmsh, "y", 34, (-43, 43)),
            cylinder(gmsh, "y", BEARING_RADIUS, (-BEARING_SPAN[1], BEARING_SPAN[1])),
        ]
        ball = (3, gmsh.model.occ.addSphere(0, 0, ROD_LENGTH, BALL_RADIUS))
        whole = cut(gmsh, [join(gmsh, [*hub, neck, bar, ball])], [cylinder(gmsh, "y", 12, (-200, 200))])
        keep_half(gmsh, whole)
        half = mesh(gmsh)
    return _both_halves(half).named({"b1": _bore(-1), "b2": _bore(1), "tip": _ball((0, 0, ROD_LENGTH))})


def _tapered_bar(gmsh: ModuleType, sections: Sequence[Sequence[float]]) -> Entity:
    """A bar of rectangular section that tapers straight between `sections`: z and half its sides along x and y."""
    up, down = list(sections), list(reversed(sections))
    flat = prism(gmsh, [(-x, -200, z) for z, x, _ in up] + [(x, -200, z) for z, x, _ in down], (0, 400, 0))
    upright = prism(gmsh, [(-200, -y, z) for z, _, y in up] + [(-200, y, z) for z, _, y in down], (400, 0, 0))
    return only(gmsh.model.occ.intersect([flat], [upright])[0])


def platform(size: float = 1.0) -> SolidMesh:
    """A plate with three S sockets round the spindle, whose nose ends in the tool point.

    Steel throughout (the spindle's rotor and stator counted as solid). Frame `platform`. Surfaces: `socket_1` ..
    `socket_3` and `tool`.
    """
    with model("platform", 35 * size) as gmsh:
        solids = [
            ring(gmsh, (101, 112), (-60, 20)),  # housing of the spindle, behind the plate
            cylinder(gmsh, "z", 112, (-166, -55)),  # the spindle's motor
            cylinder(gmsh, "z", 172, (19, 31)),  # plate
            ring(gmsh, (168, 210), (10, 40)),  # rim
            box(gmsh, (40, 205), (-34, 34), (0, 46)),  # arm with the socket
            cylinder(gmsh, "z", 50, (12, 100)),  # bearing seat
            cylinder(gmsh, "z", 31, (90, 285)),  # nose
            cylinder(gmsh, "z", 20, (285, TOOL_HEIGHT)),  # tool holder
        ]
        ball = (3, gmsh.model.occ.addSphere(SOCKET_RADIUS, 0, 0, BALL_RADIUS))
        keep_sixth(gmsh, cut(gmsh, [join(gmsh, solids)], [ball]))
        sixth = mesh(gmsh)
    sockets = {f"socket_{i + 1}": _in_limb(angle, _ball((SOCKET_RADIUS, 0, 0))) for i, angle in enumerate(LIMB_ANGLES)}
    return _three_limbs(sixth).named({**sockets, "tool": _plane(2, TOOL_HEIGHT)})


PARTS: Mapping[str, Callable[[float], SolidMesh]] = {
    "base": base,
    "board": board,
    "slider": slider,
    "rod": rod,
    "platform": platform,
}
