"""The skin of a part for pictures: few points, and how they follow the part's coordinates."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import fast_simplification
import numpy as np
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from ..arrays import FloatArray, IntArray
from ..finite_elements import FiniteElementModel

MOST_TRIANGLES = 1600


@dataclass(frozen=True, eq=False)
class Surface:
    """points (p, 3) [m] in the body frame, triangles (t, 3), recovery (p, 3, n): displacement of each point from u.

    source: the recovery, or what computes it when a picture first asks for it.
    """

    points: FloatArray
    triangles: IntArray
    source: NDArray[np.float32] | Callable[[], NDArray[np.float32]]

    @cached_property
    def recovery(self) -> NDArray[np.float32]:
        return self.source() if callable(self.source) else self.source

    def through(self, projection: FloatArray) -> Surface:
        """The surface under coordinates u' with u = P u', P (n, n')."""
        return Surface(self.points, self.triangles, np.asarray(self.recovery @ projection, dtype=np.float32))


def decimate(model: FiniteElementModel, basis: FloatArray, most_triangles: int = MOST_TRIANGLES) -> Surface | None:
    """The model's outer surface with about `most_triangles`; None for a model without one.

    The points are those of a simplified surface; each moves as the nearest finite-element node does under
    `basis` (n, r).
    """
    if model.triangles is None:
        return None
    nodes, local = np.unique(model.triangles, return_inverse=True)
    points: FloatArray = model.coordinates[nodes]
    triangles: IntArray = local.reshape(-1, 3)
    if len(triangles) > most_triangles:
        points, triangles = _simplified(points, triangles, most_triangles)
    nearest = nodes[cKDTree(model.coordinates[nodes]).query(points)[1]]
    rows = model.rows[nearest, :3]
    recovery = np.where((rows >= 0)[..., None], basis[rows], 0.0).astype(np.float32)
    return Surface(points, triangles, recovery)


def _simplified(points: FloatArray, triangles: IntArray, count: int) -> tuple[FloatArray, IntArray]:
    """Quadric edge collapse (M. Garland, P. Heckbert, Surface simplification using quadric error metrics, 1997)."""
    simple, faces = fast_simplification.simplify(
        points.astype(np.float32), triangles.astype(np.int32), target_count=count
    )
    return simple.astype(float), faces.astype(np.int64)
