"""Frequencies at any poses, each worked out for itself: no grid, no gap in the spectrum, no interpolation.

T = (K - s M)^-1 M is symmetric in the M-product, with eigenvalues mu = 1 / (lambda - s). In the dual form of a machine

    T u = G M u - G B^T S^-1 B G M u,    G = (K_0 - s M)^-1,    S = C + B G B^T,

it costs little, as only B, and bodies with a travelling contact, depend on the pose. Of the Ritz vectors X of T in one
basis for all poses, the first ones are improved by U = T X. Their Ritz values in the product u^T M T u are below the
exact ones: frequencies come out as upper bounds.

With k eigenvalues above some rho, which is counted exactly, and k Ritz vectors U of values theta above it,

    mu_i <= rho + the i-th eigenvalue of D + D^-1/2 R D^-1/2,    D = diag(theta - rho),    R = (T U)^T M T U - theta^2

(Lehmann; Parlett, The Symmetric Eigenvalue Problem, 10.5). So both sides are proved at every pose, but for rounding,
of which there is more the nearer to zero s is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from ...arrays import BoolArray, FloatArray
from ...synthesis.dual import DualSystems, dual_assembly
from ...synthesis.redundancy import without_redundant
from ..exact import part
from ..rounding import is_rigid
from . import kernels_ritz as plain
from .dual_packed import packed

if TYPE_CHECKING:
    from ...kinematics import Configurations
    from ...machine import Machine

_CHUNK = 256  # configurations at once: 30 MB at 160 coordinates


@dataclass(frozen=True, eq=False)
class RitzAtPoses:
    """Shapes V (n, r) that serve at any pose, those that matter most first; the shift s and a level for counting.

    All in [rad^2/s^2]: s is below all eigenvalues, and those that are round-off beside `rate` strain nothing. rounding:
    of frequencies (p,), relative, which is added to their bounds.
    """

    shapes: FloatArray
    shift: float
    level: float
    rate: float
    rounding: FloatArray

    @property
    def size(self) -> int:
        """Number of shapes r."""
        return int(self.shapes.shape[1])

    def at(
        self, machine: Machine, configurations: Configurations, count: int, kernels: Any = plain
    ) -> tuple[FloatArray, FloatArray, BoolArray]:
        """`frequencies` in configurations that all exist, limits left aside; none is complete where S is singular."""
        parts = [part(configurations, slice(start, start + _CHUNK)) for start in range(0, len(configurations), _CHUNK)]
        duals = (dual_assembly(machine.description, machine.parts, machine.joints, each) for each in parts)
        found = [self._or_nothing(without_redundant(dual), count, kernels) for dual in duals]
        frequencies, bounds, complete = (np.concatenate(each) for each in zip(*found, strict=True))
        return frequencies, bounds, complete

    def _or_nothing(self, dual: DualSystems, count: int, kernels: Any) -> tuple[FloatArray, FloatArray, BoolArray]:
        try:
            return self.frequencies(dual, count, kernels)
        except np.linalg.LinAlgError:
            shape = (len(dual), count)
            return np.zeros(shape), np.full(shape, np.inf), np.zeros(len(dual), dtype=bool)

    def frequencies(
        self, dual: DualSystems, count: int, kernels: Any = plain
    ) -> tuple[FloatArray, FloatArray, BoolArray]:
        """The lowest frequencies (N, count) [Hz], upper bounds of the exact ones; bounds of their relative errors; and
        whether as many Ritz values as eigenvalues lie below the level, all of these among them, and none is of a mode
        that strains nothing (N,).

        Bounds hold where that is so, and are infinite elsewhere. Raises numpy.linalg.LinAlgError where S is singular:
        rigid joints hold a motion twice, or a body alone has an eigenvalue at the level.
        """
        number, sure = kernels.below(packed(dual, self.shapes[:, :0], self.shift, self.level))
        several = min(max(count, int(number.max())), self.size)
        mu, theta, residual = _improved(kernels.moments(packed(dual, self.shapes, self.shift, self.shift), several))
        pole, mu = 1.0 / (self.level - self.shift), mu[:, :count]
        highest = np.maximum(pole + _lehmann(theta - pole, residual)[:, :count], mu)
        values = np.maximum(1.0 / mu + self.shift, -np.finfo(float).eps * self.shift)
        lower = values - (highest - mu) / (mu * highest)
        complete = sure & ((theta > pole).sum(axis=1) == number) & (number >= count)
        complete &= ((lower > 0.0) & ~is_rigid(values, np.array(self.rate))).all(axis=1)
        bounds = (values - lower) / np.where(complete[:, None], 2.0 * lower, 1.0) + self.rounding[:count]
        return np.sqrt(values) / (2.0 * np.pi), np.where(complete[:, None], bounds, np.inf), complete


def _improved(moments: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
    """From U^T M T^k U (N, 3, p, p), k = 0, 1, 2: Ritz values of T in the product u^T M T u (N, p), and in u^T M u
    (N, p), descending; and of the latter R (N, p, p)."""
    mass, once, twice = moments.swapaxes(0, 1)
    root = np.linalg.inv(np.linalg.cholesky(mass))
    theta, turn = np.linalg.eigh(root @ once @ root.swapaxes(1, 2))
    theta, vectors = theta[:, ::-1], root.swapaxes(1, 2) @ turn[:, :, ::-1]
    twice = vectors.swapaxes(1, 2) @ twice @ vectors
    scale = 1.0 / np.sqrt(theta)
    mu = np.linalg.eigvalsh(twice * scale[:, :, None] * scale[:, None])[:, ::-1]
    return mu, theta, twice - theta[:, :, None] ** 2 * np.eye(theta.shape[1])


def _lehmann(above: FloatArray, residual: FloatArray) -> FloatArray:
    """Eigenvalues of D + D^-1/2 R D^-1/2 (N, p), descending, of those values D (N, p) that are positive."""
    positive = above > 0.0
    scale = np.where(positive, 1.0 / np.sqrt(np.where(positive, above, 1.0)), 0.0)
    matrices = residual * scale[:, :, None] * scale[:, None]
    matrices += np.where(positive, above, 0.0)[:, :, None] * np.eye(above.shape[1])
    return np.asarray(np.linalg.eigvalsh(matrices)[:, ::-1])
