"""Frequencies without a gap in the spectrum: Rayleigh-Ritz on the inverse operator, in one basis for all poses.

The basis V (n, r) is made of shapes at many poses. On T = (K - s M)^-1 M, symmetric in the M-product, the Ritz values
are those of

    A = C^-1 V^T M (K - s M)^-1 M V C^-T,   C C^T = V^T M V,

which are below the exact mu = 1 / (lambda - s): frequencies come out as upper bounds. A shape slightly wrong in V does
far less harm than in V^T K V, where it strains stiff joints. A is smooth in the pose as long as s lies below all
eigenvalues, whatever the frequencies do, and is interpolated.

The leading block of A is that of the first shapes alone. By how much the two differ estimates what the whole basis
still lacks; twice that is taken for a bound, which holds as long as further shapes add less than the last ones did.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..synthesis.batch import Systems
from . import kernels as plain
from .tensor import Interpolated

_LACKING = 2.0  # times what the last quarter of the shapes adds


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

    @property
    def first(self) -> int:
        """Number of shapes of the smaller basis that the whole one is compared with."""
        return self.size - max(4, self.size // 4)


def leading_shapes(mass: FloatArray, shapes: FloatArray, count: int) -> FloatArray:
    """The `count` combinations (n, count) of shapes (n, k) that hold most of them, orthonormal in M (n, n)."""
    values, vectors = np.linalg.eigh(shapes.T @ mass @ shapes)
    some = slice(None, -count - 1, -1)
    kept = values[some] > 1e-12 * values[-1]
    return np.asarray(shapes @ (vectors[:, some][:, kept] / np.sqrt(values[some][kept])))


def ritz_matrices(basis: RitzBasis, systems: Systems) -> dict[str, FloatArray]:
    """A (N, r, r), packed."""
    momenta, r = systems.mass @ basis.shapes, basis.size
    inverse = np.empty((len(momenta), r, r))
    for i, (mass, stiffness, free) in enumerate(systems.pencils):
        loads = free.T @ momenta[i]
        pencil = stiffness - basis.shift * mass
        scale = 1.0 / np.sqrt(np.diag(pencil))
        inverse[i] = (loads * scale[:, None]).T @ np.linalg.solve(
            pencil * np.outer(scale, scale), loads * scale[:, None]
        )
    root = np.linalg.inv(np.linalg.cholesky(basis.shapes.T @ momenta))
    inverse = root @ inverse @ root.swapaxes(1, 2)
    rows, columns = np.tril_indices(r)
    return {"inverse": inverse[:, rows, columns]}


@dataclass(frozen=True, eq=False)
class RitzInterpolation(Interpolated):
    """A tensor of A. The error is that of mu, absolute [s^2/rad^2]."""

    basis: RitzBasis

    @property
    def shift(self) -> float:
        """Below all eigenvalues [rad^2/s^2]."""
        return self.basis.shift

    def frequencies(
        self, values: FloatArray, count: int, kernels: Any = plain
    ) -> tuple[FloatArray, FloatArray, IntArray]:
        """The lowest frequencies (m, count) [Hz] of interpolated values (e, m), bounds of their relative errors, and
        how many Ritz values lie below the level (m,)."""
        matrices = plain.unpacked(values[self.parts["inverse"]], self.basis.size)
        every, first = (
            np.linalg.eigvalsh(each) for each in (matrices, matrices[:, : self.basis.first, : self.basis.first])
        )
        mu, less = every[:, : -count - 1 : -1], first[:, : -count - 1 : -1]
        eigenvalues = np.maximum(1.0 / mu + self.shift, np.finfo(float).tiny)
        off = (_LACKING * np.abs(mu - less) + self.error + self.asymmetry * mu) / mu**2
        below = (every > 1.0 / (self.basis.level - self.shift)).sum(axis=1)
        return np.sqrt(eigenvalues) / (2.0 * np.pi), off / (2.0 * eigenvalues), below
