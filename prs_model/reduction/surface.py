"""The skin of a part for pictures: few points, and how they follow the part's coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..finite_elements import FiniteElementModel

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]

MOST_POINTS = 800


@dataclass(frozen=True, eq=False)
class Surface:
    """points (p, 3) [m] in the body frame, triangles (t, 3), recovery (p, 3, n): displacement of each point from u."""

    points: FloatArray
    triangles: IntArray
    recovery: NDArray[np.float32]


def decimate(model: FiniteElementModel, basis: FloatArray, most_points: int = MOST_POINTS) -> Surface | None:
    """The model's outer surface with at most `most_points` of its nodes, moved by `basis` (n, r); None without one."""
    if model.triangles is None:
        return None
    nodes, triangles = cluster(model.coordinates, model.triangles, most_points)
    rows = model.rows[nodes, :3]
    recovery = np.where((rows >= 0)[..., None], basis[rows], 0.0).astype(np.float32)
    return Surface(model.coordinates[nodes], triangles, recovery)


def cluster(points: FloatArray, triangles: IntArray, most_points: int) -> tuple[IntArray, IntArray]:
    """Vertex clustering: one vertex for each cell of the finest cubic grid that leaves at most `most_points`.

    Vertices of a cell are merged only where the surface faces the same way, so both faces of a thin wall remain.
    Returns indices of the vertices kept and triangles (t, 3) among them.
    """
    used, local = np.unique(triangles, return_inverse=True)
    local = local.reshape(-1, 3)
    if len(used) <= most_points:
        return used, local
    faces = _facing(points[used], local)
    low, high = 0.0, float(np.ptp(points[used], axis=0).max())
    for _ in range(24):
        middle = (low + high) / 2.0
        if len(np.unique(_cells(points[used], faces, middle), axis=0)) > most_points:
            low = middle
        else:
            high = middle
    _, kept, cell = np.unique(_cells(points[used], faces, high), axis=0, return_index=True, return_inverse=True)
    merged = cell.ravel()[local]
    distinct = (merged[:, 0] != merged[:, 1]) & (merged[:, 1] != merged[:, 2]) & (merged[:, 2] != merged[:, 0])
    merged = merged[distinct]
    first = np.unique(np.sort(merged, axis=1), axis=0, return_index=True)[1]
    seen, compact = np.unique(merged[np.sort(first)], return_inverse=True)
    return used[_central(points[used], cell.ravel(), kept)][seen], compact.reshape(-1, 3)


def _cells(points: FloatArray, faces: IntArray, size: float) -> IntArray:
    grid = np.floor((points - points.min(axis=0)) / size).astype(np.int64)
    return np.column_stack([grid, faces])


def _facing(points: FloatArray, triangles: IntArray) -> IntArray:
    """Which of the six axis directions the surface faces most at each vertex, 0..5."""
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    vertex = np.zeros_like(points)
    for corner in range(3):
        np.add.at(vertex, triangles[:, corner], normals)
    return np.asarray(np.argmax(np.hstack([vertex, -vertex]), axis=1))


def _central(points: FloatArray, cell: IntArray, kept: IntArray) -> IntArray:
    """Of each cell, the vertex closest to the mean of the cell's vertices."""
    count = np.bincount(cell)
    mean = np.column_stack([np.bincount(cell, weights=points[:, axis]) / count for axis in range(3)])
    distance = np.linalg.norm(points - mean[cell], axis=1)
    order = np.lexsort((distance, cell))
    return order[np.searchsorted(cell[order], np.arange(len(kept)))]
