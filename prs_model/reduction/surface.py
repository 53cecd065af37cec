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
        return Surface(self.points, self.triangles, lambda: np.asarray(self.recovery @ projection, dtype=np.float32))


@dataclass(frozen=True, eq=False)
class Skin:
    """Few points (p, 3) [m] of a model's outer surface, triangles (t, 3) of them, and the node (p,) each follows."""

    points: FloatArray
    triangles: IntArray
    nodes: IntArray

    def rows(self, model: FiniteElementModel) -> IntArray:
        """(p, 3): the rows of the points' translations in the model, -1 where the node is held."""
        return model.rows[self.nodes, :3]


def skin(model: FiniteElementModel, most_triangles: int = MOST_TRIANGLES) -> Skin | None:
    """The model's outer surface simplified to about `most_triangles`; None for a model without one.

    A point follows the finite-element node nearest to it. The choice depends on the mesh alone, so that all models of
    one part, reduced or not, are seen at the same points.
    """
    if model.triangles is None:
        return None
    nodes, local = np.unique(model.triangles, return_inverse=True)
    points: FloatArray = model.coordinates[nodes]
    triangles: IntArray = local.reshape(-1, 3)
    if len(triangles) > most_triangles:
        points, triangles = _simplified(points, triangles, most_triangles)
    nearest = nodes[cKDTree(model.coordinates[nodes]).query(points)[1]]
    return Skin(points, triangles, nearest)


def decimate(model: FiniteElementModel, basis: FloatArray, most_triangles: int = MOST_TRIANGLES) -> Surface | None:
    """The skin of a model, its points moving as their nodes do under `basis` (n, r); None for one without surface."""
    seen = skin(model, most_triangles)
    if seen is None:
        return None
    rows = seen.rows(model)
    recovery = np.where((rows >= 0)[..., None], basis[rows], 0.0).astype(np.float32)
    return Surface(seen.points, seen.triangles, recovery)


def _simplified(points: FloatArray, triangles: IntArray, count: int) -> tuple[FloatArray, IntArray]:
    """Quadric edge collapse (M. Garland, P. Heckbert, Surface simplification using quadric error metrics, 1997)."""
    simple, faces = fast_simplification.simplify(
        points.astype(np.float32), triangles.astype(np.int32), target_count=count
    )
    return simple.astype(float), faces.astype(np.int64)
