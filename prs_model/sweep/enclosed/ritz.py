"""A basis of shapes at many poses, for Rayleigh-Ritz at any pose."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import FloatArray


@dataclass(frozen=True, eq=False)
class RitzBasis:
    """Shapes V (n, r), those that matter most first; the shift s and a level [rad^2/s^2] for counting."""

    shapes: FloatArray
    shift: float
    level: float

    @property
    def size(self) -> int:
        """Number of shapes r."""
        return int(self.shapes.shape[1])


def leading_shapes(mass: FloatArray, shapes: FloatArray, count: int) -> FloatArray:
    """The `count` combinations (n, count) of shapes (n, k) that hold most of them, orthonormal in M (n, n)."""
    values, vectors = np.linalg.eigh(shapes.T @ mass @ shapes)
    some = slice(None, -count - 1, -1)
    kept = values[some] > 1e-12 * values[-1]
    return np.asarray(shapes @ (vectors[:, some][:, kept] / np.sqrt(values[some][kept])))
