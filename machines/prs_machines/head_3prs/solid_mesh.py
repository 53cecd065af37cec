"""Meshes of ten-node tetrahedra: mirrored, rotated and merged copies, named surfaces, the file for the reducer."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from math import cos, radians, sin
from pathlib import Path
from typing import Any

import meshio
import numpy as np
from scipy.spatial import cKDTree

from prs_model.arrays import BoolArray, FloatArray, IntArray
from prs_model.errors import PrsError
from prs_reducers.elements.tetrahedra import outer_faces

Where = Callable[[FloatArray], BoolArray]

_EDGES = np.array([[0, 1], [1, 2], [0, 2], [0, 3], [1, 3], [2, 3]])  # whose middles are nodes 4 .. 9
_TURNED_OVER = [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]  # the same tetrahedron with its first two corners exchanged


@dataclass(frozen=True)
class SolidMesh:
    """Points (n, 3) in millimetres, tetrahedra (m, 10) in VTK order, facets (k, 6) of each named surface."""

    points: FloatArray
    tets: IntArray
    surfaces: Mapping[str, IntArray] = field(default_factory=dict)

    def volume(self) -> float:
        """Volume in mm^3, edges taken as straight."""
        a, b, c, d = (self.points[self.tets[:, i]] for i in range(4))
        return float(np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a).sum() / 6)

    def named(self, surfaces: Mapping[str, Where]) -> SolidMesh:
        """The same mesh with its surfaces: the outer facets all of whose nodes are where each test says."""
        facets = outer_faces(self.tets)
        found = {name: facets[where(self.points)[facets].all(axis=1)] for name, where in surfaces.items()}
        empty = [name for name, some in found.items() if not len(some)]
        if empty:
            raise PrsError(f"no facet of the mesh lies on {', '.join(empty)}; mesh the part more finely")
        return SolidMesh(self.points, self.tets, found)

    def write(self, path: Path, volume: str) -> None:
        """Write a gmsh file with one physical group per surface and one, `volume`, for the solid."""
        blocks: list[tuple[str, IntArray]] = [("triangle6", facets) for facets in self.surfaces.values()]
        blocks.append(("tetra10", self.tets))
        tags = [np.full(len(cells), i + 1, dtype=np.int32) for i, (_, cells) in enumerate(blocks)]
        groups: dict[str, Any] = {name: np.array([i + 1, 2]) for i, name in enumerate(self.surfaces)}
        groups[volume] = np.array([len(blocks), 3])
        path.parent.mkdir(parents=True, exist_ok=True)
        meshio.write(
            path,
            meshio.Mesh(
                self.points,
                blocks,
                cell_data={"gmsh:physical": tags, "gmsh:geometrical": tags},
                field_data=groups,
            ),
            file_format="gmsh22",
            binary=True,
        )


def mirrored(mesh: SolidMesh, axis: int = 1) -> SolidMesh:
    """The mirror image in the plane through the origin normal to a coordinate axis, elements turned over."""
    points = mesh.points.copy()
    points[:, axis] *= -1
    return SolidMesh(points, mesh.tets[:, _TURNED_OVER])


def rotated(mesh: SolidMesh, degrees: float) -> SolidMesh:
    """The mesh turned about z."""
    return SolidMesh(turned(mesh.points, degrees), mesh.tets)


def turned(points: FloatArray, degrees: float) -> FloatArray:
    """Points (n, 3) turned about z."""
    c, s = cos(radians(degrees)), sin(radians(degrees))
    return np.asarray(points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]))


def straightened(mesh: SolidMesh) -> SolidMesh:
    """The mesh with straight edges on those elements that a curved edge would turn inside out."""
    bad = mesh.tets[_least_jacobian(mesh) < 0.05]
    points = mesh.points.copy()
    points[bad[:, 4:]] = (points[bad[:, _EDGES[:, 0]]] + points[bad[:, _EDGES[:, 1]]]) / 2
    return SolidMesh(points, mesh.tets)


def _least_jacobian(mesh: SolidMesh) -> FloatArray:
    """Least Jacobian determinant (m,) at the ten nodes, relative to the straight element's."""
    places = np.vstack([np.eye(4), np.eye(4)[_EDGES].mean(axis=1)])  # barycentric, (10, 4)
    gradients = np.zeros((10, 10, 4))  # of each shape function at each node
    for i in range(4):
        gradients[:, i, i] = 4 * places[:, i] - 1
    for i, (a, b) in enumerate(_EDGES):
        gradients[:, 4 + i, a], gradients[:, 4 + i, b] = 4 * places[:, b], 4 * places[:, a]
    local = gradients[:, :, 1:] - gradients[:, :, :1]
    determinants = np.linalg.det(np.einsum("qni,mnj->mqij", local, mesh.points[mesh.tets]))
    corners = mesh.points[mesh.tets[:, :4]]
    return np.asarray(determinants.min(axis=1) / np.linalg.det(corners[:, 1:] - corners[:, :1]))


def merged(meshes: Sequence[SolidMesh], tolerance: float = 1e-4) -> SolidMesh:
    """One mesh of several whose common nodes lie within `tolerance` (mm) of each other."""
    points = np.concatenate([mesh.points for mesh in meshes])
    shift = np.cumsum([0] + [len(mesh.points) for mesh in meshes])
    tets = np.concatenate([mesh.tets + start for mesh, start in zip(meshes, shift, strict=False)])
    first = np.arange(len(points))
    pairs = cKDTree(points).query_pairs(tolerance, output_type="ndarray")
    np.minimum.at(first, pairs.max(axis=1), pairs.min(axis=1))
    kept, new = np.unique(first, return_inverse=True)
    return SolidMesh(points[kept], new[tets])
