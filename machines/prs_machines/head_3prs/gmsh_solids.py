"""Short words for gmsh's OpenCASCADE kernel: open a model, add and combine solids, mesh them. Millimetres."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from importlib import import_module
from math import cos, pi, radians, sin
from types import ModuleType
from typing import TypeAlias

import numpy as np

from prs_model.errors import MissingExtraError, PrsError

from .solid_mesh import SolidMesh, straightened

Entity: TypeAlias = tuple[int, int]


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
def model(name: str, length: float) -> Iterator[ModuleType]:
    """An empty gmsh model whose elements are `length` long, smaller on curved surfaces."""
    gmsh = gmsh_module()
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Verbosity", 1)
        gmsh.option.setNumber("General.NumThreads", 1)
        gmsh.option.setNumber("Mesh.MeshSizeMax", length)
        gmsh.option.setNumber("Mesh.MeshSizeMin", 0.3 * length)
        gmsh.option.setNumber("Mesh.MeshSizeFromCurvature", 14)
        gmsh.option.setNumber("Mesh.MeshSizeExtendFromBoundary", 0)
        gmsh.model.add(name)
        yield gmsh
    finally:
        gmsh.finalize()


def mesh(gmsh: ModuleType) -> SolidMesh:
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


def box(gmsh: ModuleType, x: Sequence[float], y: Sequence[float], z: Sequence[float]) -> Entity:
    """A block from .. to along x, y and z."""
    return 3, gmsh.model.occ.addBox(x[0], y[0], z[0], x[1] - x[0], y[1] - y[0], z[1] - z[0])


def turned_box(gmsh: ModuleType, degrees: float, *sides: Sequence[float]) -> Entity:
    """A block from .. to along x, y and z, then turned about the z axis."""
    block = box(gmsh, *sides)
    gmsh.model.occ.rotate([block], 0, 0, 0, 0, 0, 1, radians(degrees))
    return block


def cylinder(gmsh: ModuleType, axis: str, radius: float, along: Sequence[float]) -> Entity:
    """A cylinder about the y or z axis."""
    start, length = along[0], along[1] - along[0]
    place = (0, start, 0, 0, length, 0) if axis == "y" else (0, 0, start, 0, 0, length)
    return 3, gmsh.model.occ.addCylinder(*place, radius)


def ring(gmsh: ModuleType, radii: Sequence[float], z: Sequence[float]) -> Entity:
    """A ring about the z axis between two radii."""
    return cut(gmsh, [cylinder(gmsh, "z", radii[1], z)], [cylinder(gmsh, "z", radii[0], z)])


def prism(gmsh: ModuleType, corners: Sequence[Sequence[float]], along: Sequence[float]) -> Entity:
    """A polygon moved along a vector."""
    occ = gmsh.model.occ
    points = [occ.addPoint(*corner) for corner in corners]
    lines = [occ.addLine(a, b) for a, b in zip(points, points[1:] + points[:1], strict=True)]
    face = occ.addPlaneSurface([occ.addCurveLoop(lines)])
    return only([entity for entity in occ.extrude([(2, face)], *along) if entity[0] == 3])


def join(gmsh: ModuleType, parts: Sequence[Entity]) -> Entity:
    """The union of overlapping solids."""
    return only(gmsh.model.occ.fuse([parts[0]], list(parts[1:]))[0])


def cut(gmsh: ModuleType, parts: Sequence[Entity], tools: Sequence[Entity]) -> Entity:
    """What the tools leave of a solid."""
    return only(gmsh.model.occ.cut(list(parts), list(tools))[0])


def keep_half(gmsh: ModuleType, part: Entity) -> Entity:
    """The half of a part with y >= 0."""
    half = box(gmsh, (-2e3, 2e3), (0, 2e3), (-2e3, 2e3))
    return only(gmsh.model.occ.intersect([part], [half])[0])


def keep_sixth(gmsh: ModuleType, part: Entity) -> Entity:
    """The sector of 60 degrees from the limb's plane (y = 0) on."""
    corners = [(0.0, 0.0, -2e3), (4e3, 0.0, -2e3), (4e3 * cos(pi / 3), 4e3 * sin(pi / 3), -2e3)]
    wedge = prism(gmsh, corners, (0, 0, 4e3))
    return only(gmsh.model.occ.intersect([part], [wedge])[0])


def only(entities: Sequence[Entity]) -> Entity:
    """The one solid of a list. Raises PrsError when an operation left several or none."""
    if len(entities) != 1:
        raise PrsError(f"gmsh left {len(entities)} solids of a part, expected one")
    return entities[0]
