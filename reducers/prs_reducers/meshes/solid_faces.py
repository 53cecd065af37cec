"""Faces of solid elements as Abaqus and CalculiX number them, and the outer surface of a mesh of several kinds."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from prs_model.arrays import FloatArray, IntArray

# corners of the faces S1, S2, .. seen from outside, and the corners between which mid-side nodes stand, by corner count
FACES = {
    4: ((0, 2, 1), (0, 1, 3), (1, 2, 3), (0, 3, 2)),
    6: ((0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)),
    8: ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)),
}
EDGES = {
    4: ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)),
    6: ((0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)),
    8: ((0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)),
}
CORNERS = {4: 4, 10: 4, 6: 6, 15: 6, 8: 8, 20: 8}
"""Number of corners of a solid element of so many nodes."""


def face_nodes(nodes: IntArray, face: int) -> tuple[IntArray, IntArray]:
    """Corners (e, 3 or 4), outward, and mid-side nodes (e, 0, 3 or 4) of face 0, 1, .. of elements (e, 4 to 20)."""
    corners = CORNERS[nodes.shape[1]]
    around = FACES[corners][face]
    if nodes.shape[1] == corners:
        return nodes[:, around], nodes[:, :0]
    between = {frozenset(edge): corners + place for place, edge in enumerate(EDGES[corners])}
    middles = [between[frozenset(pair)] for pair in zip(around, around[1:] + around[:1], strict=True)]
    return nodes[:, around], nodes[:, middles]


@dataclass(frozen=True, eq=False)
class OuterSurface:
    """triangles (t, 3), outward; mid_sides as FiniteElementModel has them; each point's share (n,) in the area."""

    triangles: IntArray
    mid_sides: IntArray | None
    areas: FloatArray


def outer_surface(solids: Mapping[int, IntArray], points: FloatArray) -> OuterSurface:
    """The faces that only one element has; those of four corners as two triangles.

    solids: elements (e, 4 to 20) by their number of nodes. Mid-side nodes are known when all triangles have them, or
    none: not of halves of eight-node faces.
    """
    faces = [face_nodes(nodes, f) for nodes in solids.values() for f in range(len(FACES[CORNERS[nodes.shape[1]]]))]
    keys = np.concatenate([_padded(np.sort(corners, axis=1)) for corners, _ in faces] or [np.zeros((0, 4), dtype=int)])
    _, place, count = np.unique(keys, axis=0, return_inverse=True, return_counts=True)
    alone, start = count[place.ravel()] == 1, 0
    triangles: list[IntArray] = [np.zeros((0, 3), dtype=np.int64)]
    between: list[IntArray] = []
    areas = np.zeros(len(points))
    for corners, middles in faces:
        outer = alone[start : start + len(corners)]
        start += len(corners)
        triangles.append(split(corners[outer]))
        between.append(np.tile(middles[outer], (corners.shape[1] - 2, 1)))
        areas += area_shares(corners[outer], middles[outer], points)
    widths = {each.shape[1] for each in between if len(each)}
    known = np.concatenate([each for each in between if len(each)]) if widths in ({0}, {3}) else None
    return OuterSurface(np.concatenate(triangles), known, areas)


def split(corners: IntArray) -> IntArray:
    """Faces (f, 3 or 4) as triangles."""
    return corners if corners.shape[1] == 3 else np.concatenate([corners[:, :3], corners[:, [0, 2, 3]]])


def area_shares(corners: IntArray, middles: IntArray, points: FloatArray) -> FloatArray:
    """(n,): each face's area spread evenly over its mid-side nodes, or its corners where it has none."""
    triangles = points[split(corners)]
    cross = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    areas = np.linalg.norm(cross, axis=1).reshape(corners.shape[1] - 2, len(corners)).sum(axis=0) / 2.0
    bearing = middles if middles.shape[1] else corners
    weights = np.repeat(areas / bearing.shape[1], bearing.shape[1])
    return np.asarray(np.bincount(bearing.ravel(), weights=weights, minlength=len(points)), dtype=float)


def _padded(faces: IntArray) -> IntArray:
    return faces if faces.shape[1] == 4 else np.column_stack([np.full(len(faces), -1), faces])
