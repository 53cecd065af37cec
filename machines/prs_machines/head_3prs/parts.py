"""The five parts of the head as solids: one function a part, millimetres, in the part's URDF frame.

Each part is symmetric to the limb's plane; base and platform are so three times. Half a part (or a sixth) is
modelled and meshed with gmsh's OpenCASCADE kernel and then copied, so that the meshes have the symmetry exactly.
`size` multiplies every element length; 1 gives about 3e5 degrees of freedom in the five parts together.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from importlib import import_module
from math import cos, log2, pi, sin
from types import ModuleType
from typing import TypeAlias

import numpy as np

from prs_model.errors import MissingExtraError, PrsError

from .solid_mesh import BoolArray, FloatArray, SolidMesh, Where, merged, mirrored, rotated, straightened, turned

Entity: TypeAlias = tuple[int, int]

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


def gmsh_module() -> ModuleType:
    """The gmsh package. Raises MissingExtraError with what to install."""
    try:
        return import_module("gmsh")
    except (ImportError, OSError) as error:
        raise MissingExtraError(
            "gmsh",
            "mesh",
            "rebuilding the meshes of head_3prs (on Debian also apt-get install libglu1-mesa libxrender1 "
            f"libxcursor1 libxft2 libxinerama1; the import said: {error})",
        ) from error


@contextmanager
def _model(name: str, length: float) -> Iterator[ModuleType]:
    """An empty gmsh model whose elements are `length` long, smaller on curved surfaces."""
    gmsh = gmsh_module()
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Verbosity", 1)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.option.setNumber("Mesh.MeshSizeMax", length)
        gmsh.option.setNumber("Mesh.MeshSizeMin", 0.3 * length)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 20)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.model.add(name)
        yield gmsh
    finally:
        gmsh.finalize()


def _mesh(gmsh: ModuleType) -> SolidMesh:
    """Mesh the model with ten-node tetrahedra; nodes of the mirror plane y = 0 are put exactly on it."""
    gmsh.model.occ.synchronize()
    gmsh.model.mesh.generate(3)
    gmsh.model.mesh.setOrder(2)
    tags, coordinates, _ = gmsh.model.mesh.getNodes()
    (kind,), _, (connectivity,) = gmsh.model.mesh.getElements(3)
    if kind != 11:
        raise PrsError(f"gmsh made elements of type {kind}, expected ten-node tetrahedra only")
    position = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    position[tags] = np.arange(len(tags))
    tets = position[connectivity.reshape(-1, 10)][:, [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]]
    used, tets = np.unique(tets, return_inverse=True)
    points = coordinates.reshape(-1, 3)[used]
    points[np.abs(points[:, 1]) < 1e-6, 1] = 0.0
    return straightened(SolidMesh(points, tets.reshape(-1, 10)))


def _both_halves(half: SolidMesh) -> SolidMesh:
    return merged([half, mirrored(half)])


def _three_limbs(sixth: SolidMesh) -> SolidMesh:
    third = _both_halves(sixth)
    return merged([rotated(third, angle) for angle in LIMB_ANGLES])


# ── solids, written short ────────────────────────────────────────────────────────────────────────────


def _box(gmsh: ModuleType, x: Sequence[float], y: Sequence[float], z: Sequence[float]) -> Entity:
    return 3, gmsh.model.occ.addBox(x[0], y[0], z[0], x[1] - x[0], y[1] - y[0], z[1] - z[0])


def _round(gmsh: ModuleType, axis: str, radius: float, along: Sequence[float]) -> Entity:
    """A cylinder about the y or z axis."""
    start, length = along[0], along[1] - along[0]
    place = (0, start, 0, 0, length, 0) if axis == "y" else (0, 0, start, 0, 0, length)
    return 3, gmsh.model.occ.addCylinder(*place, radius)


def _ring(gmsh: ModuleType, radii: Sequence[float], z: Sequence[float]) -> Entity:
    return _cut(gmsh, [_round(gmsh, "z", radii[1], z)], [_round(gmsh, "z", radii[0], z)])


def _prism(gmsh: ModuleType, corners: Sequence[Sequence[float]], along: Sequence[float]) -> Entity:
    """A polygon moved along a vector."""
    occ = gmsh.model.occ
    points = [occ.addPoint(*corner) for corner in corners]
    lines = [occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    return _only([entity for entity in occ.extrude([(2, face)], *along) if entity[0] == 3])


def _join(gmsh: ModuleType, parts: Sequence[Entity]) -> Entity:
    return _only(gmsh.model.occ.fuse([parts[0]], list(parts[1:]))[0])


def _cut(gmsh: ModuleType, parts: Sequence[Entity], tools: Sequence[Entity]) -> Entity:
    return _only(gmsh.model.occ.cut(list(parts), list(tools))[0])


def _keep_half(gmsh: ModuleType, part: Entity) -> Entity:
    """The half of a part with y >= 0."""
    half = _box(gmsh, (-2e3, 2e3), (0, 2e3), (-2e3, 2e3))
    return _only(gmsh.model.occ.intersect([part], [half])[0])


def _keep_sixth(gmsh: ModuleType, part: Entity) -> Entity:
    """The sector of 60 degrees from the limb's plane (y = 0) on."""
    corners = [(0.0, 0.0, -2e3), (4e3, 0.0, -2e3), (4e3 * cos(pi / 3), 4e3 * sin(pi / 3), -2e3)]
    wedge = _prism(gmsh, corners, (0, 0, 4e3))
    return _only(gmsh.model.occ.intersect([part], [wedge])[0])


def _only(entities: Sequence[Entity]) -> Entity:
    if len(entities) != 1:
        raise PrsError(f"gmsh left {len(entities)} solids of a part, expected one")
    return entities[0]


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
    with _model("base", 56 * size) as gmsh:
        column = [
            _box(gmsh, (inner, inner + 8), (60, 100), (low, high)),  # bolted strip
            _box(gmsh, (inner + 4, inner + 17), (-112, 112), (rear, front)),  # face of the column
            _box(gmsh, (inner + 12, 540), (72, 88), (rear, front)),  # side wall
            _box(gmsh, (0, 544), (-9, 9), (rear, low - 5)),  # rib on the rear plate
            _box(gmsh, (inner + 12, 540), (-9, 9), (rear, low + 120)),  # middle wall
            _box(gmsh, (0, 544), (-28, 28), (10, rear + 5)),  # radial wall that carries the drum
            _box(gmsh, (0, 556), (-60, 60), (0, 20)),  # foot
        ]
        drum = [
            _ring(gmsh, (540, 546), (rear, front)),  # shell
            _ring(gmsh, (395, 544), (front - 12, front)),  # front plate
            _ring(gmsh, (150, 544), (rear, rear + 14)),  # rear plate
            _ring(gmsh, (290, 304), (rear - 45, rear + 5)),  # stiffener under it
            _round(gmsh, "z", 60, (0, rear + 14)),  # hub
            _ring(gmsh, (500, 546), (0, 10)),  # foot ring
        ]
        _keep_sixth(gmsh, _join(gmsh, column + drum))
        sixth = _mesh(gmsh)
    strip = _plane(0, inner)
    seats = {f"seat_{i + 1}": _in_limb(angle, strip) for i, angle in enumerate(LIMB_ANGLES)}
    return _three_limbs(sixth).named({"foot": _plane(2, 0.0), **seats})


def board(size: float = 1.0) -> SolidMesh:
    """A plate with two rails in front and two bolted strips behind, meshed alike all along the travel.

    Steel. Frame `board_i`. Surfaces: `rail_left` (y < 0), `rail_right` and `seat`. The element length along z
    divides 25 mm, so that contacts 100 mm apart take hold of congruent facets.
    """
    outline = [
        (104, 0), (104, 68.5), (CONTACT, 68.5), (CONTACT, 91.5), (104, 91.5), (104, 115),
        (130, 115), (130, 100), (SEAT, 100), (SEAT, 60), (130, 60), (130, 0),
    ]  # fmt: skip
    layers = 24 * 2 ** max(0, round(log2(2 / size)))
    with _model("board", 17 * size) as gmsh:
        occ = gmsh.model.occ
        corners = [occ.addPoint(x, y, RAILS[0]) for x, y in outline]
        lines = [occ.addLine(a, b) for a, b in zip(corners, corners[1:] + corners[:1], strict=True)]
        section = occ.addPlaneSurface([occ.addCurveLoop(lines)])
        occ.extrude([(2, section)], 0, 0, RAILS[1] - RAILS[0], numElements=[layers])
        half = _mesh(gmsh)
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
    with _model("slider", 13.5 * size) as gmsh:
        blocks = [_box(gmsh, (60, CONTACT), y, (z - half_length, z + half_length)) for z in (-CARRIAGE_Z, CARRIAGE_Z)]
        lug = [
            _box(gmsh, (0, 45), BEARING_SPAN, (-38, 38)),
            _round(gmsh, "y", 38, BEARING_SPAN),
        ]
        plate = _box(gmsh, (38, 68), (0, 108), (-100, 100))
        _cut(gmsh, [_join(gmsh, [plate, *lug, *blocks])], [_round(gmsh, "y", BEARING_RADIUS, (0, 200))])
        half = _mesh(gmsh)

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
    """A hub with two journals for the R joint's bearings and a tapered bar that ends in the ball of the S joint.

    Steel. Frame `rod_i`. Surfaces: `b1` (y < 0), `b2` and `tip`.
    """
    with _model("rod", 14 * size) as gmsh:
        bar = _tapered_bar(gmsh, (0, 338), ((14.5, 55), (13, 22)))
        hub = [_round(gmsh, "y", 34, (-43, 43)), _round(gmsh, "y", BEARING_RADIUS, (-BEARING_SPAN[1], BEARING_SPAN[1]))]
        ball = (3, gmsh.model.occ.addSphere(0, 0, ROD_LENGTH, BALL_RADIUS))
        whole = _cut(gmsh, [_join(gmsh, [*hub, bar, ball])], [_round(gmsh, "y", 12, (-200, 200))])
        _keep_half(gmsh, whole)
        half = _mesh(gmsh)
    return _both_halves(half).named({"b1": _bore(-1), "b2": _bore(1), "tip": _ball((0, 0, ROD_LENGTH))})


def _tapered_bar(gmsh: ModuleType, z: Sequence[float], halves: Sequence[Sequence[float]]) -> Entity:
    """A bar of rectangular section; `halves` are half its sides along x and y at either end."""
    (x0, y0), (x1, y1) = halves
    low, high = z
    flat = _prism(gmsh, [(-x0, -200, low), (x0, -200, low), (x1, -200, high), (-x1, -200, high)], (0, 400, 0))
    upright = _prism(gmsh, [(-200, -y0, low), (-200, y0, low), (-200, y1, high), (-200, -y1, high)], (400, 0, 0))
    return _only(gmsh.model.occ.intersect([flat], [upright])[0])


def platform(size: float = 1.0) -> SolidMesh:
    """A plate with three S sockets round the spindle, whose nose ends in the tool point.

    Steel throughout (the spindle's rotor and stator counted as solid). Frame `platform`. Surfaces: `socket_1` ..
    `socket_3` and `tool`.
    """
    with _model("platform", 22 * size) as gmsh:
        solids = [
            _round(gmsh, "z", 115, (-122, 118)),  # spindle
            _round(gmsh, "z", 42, (118, 285)),  # nose
            _round(gmsh, "z", 30, (285, TOOL_HEIGHT)),  # tool holder
            _round(gmsh, "z", 142, (2, 64)),  # hub
            _box(gmsh, (60, 197), (-32, 32), (0, 46)),  # arm
        ]
        ball = (3, gmsh.model.occ.addSphere(SOCKET_RADIUS, 0, 0, BALL_RADIUS))
        _keep_sixth(gmsh, _cut(gmsh, [_join(gmsh, solids)], [ball]))
        sixth = _mesh(gmsh)
    sockets = {f"socket_{i + 1}": _in_limb(angle, _ball((SOCKET_RADIUS, 0, 0))) for i, angle in enumerate(LIMB_ANGLES)}
    return _three_limbs(sixth).named({**sockets, "tool": _plane(2, TOOL_HEIGHT)})


PARTS: Mapping[str, Callable[[float], SolidMesh]] = {
    "base": base,
    "board": board,
    "slider": slider,
    "rod": rod,
    "platform": platform,
}
