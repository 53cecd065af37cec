"""Frequencies, and what comes with them, from matrices of the smooth frame interpolated between nodes.

At each pose the interpolated L (see `frames`) is diagonalised.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...arrays import FloatArray, IntArray
from .. import kernels as plain
from .counting import Counting
from .frames import Frame
from .symmetry import Symmetry
from .tensor import Tensor


@dataclass(frozen=True, eq=False)
class Interpolation(Tensor):
    """A tensor of L, and of what else is carried, with shapes at one pose by name; frame: the modes of L.

    parts: what lies where among the values. error: bound of that of log(lambda - shift), anywhere. joints: those that
    come near a limit, whose values are interpolated too. symmetry: of the poses that stand for all. counting: of
    eigenvalues below a level in the gap, None where all there are are followed.
    """

    frame: Frame
    shapes: Mapping[str, tuple[int, ...]]
    parts: Mapping[str, slice]
    error: float
    joints: tuple[int, ...]
    symmetry: Symmetry | None
    counting: Counting | None

    @property
    def asymmetry(self) -> float:
        """What poses that stand for each other may differ by in log(lambda - shift)."""
        return 0.0 if self.symmetry is None else self.symmetry.defect

    @property
    def shift(self) -> float:
        """Below all eigenvalues [rad^2/s^2]."""
        return self.frame.shift

    def frequencies(
        self, values: FloatArray, count: int, kernels: Any = plain
    ) -> tuple[FloatArray, FloatArray, IntArray]:
        """The lowest frequencies (m, count) [Hz] of interpolated values (e, m), bounds of their relative errors, and
        how many modes it has below the level of its counting (m,)."""
        packed = np.ascontiguousarray(values[self.parts["logarithm"]])
        every = kernels.eigenvalues(packed, self.frame.size)
        eigenvalues = np.maximum(np.exp(every[:count].T) + self.shift, 0.0)
        return np.sqrt(eigenvalues) / (2.0 * np.pi), self.bound(eigenvalues), self._below(every)

    def bound(self, eigenvalues: FloatArray) -> FloatArray:
        """Of the relative errors of the frequencies of eigenvalues [rad^2/s^2]."""
        away = 1.0 if self.shift == 0.0 else (eigenvalues - self.shift) / np.maximum(eigenvalues, np.finfo(float).tiny)
        return np.asarray(np.broadcast_to((self.error + self.asymmetry) / 2.0 * away, eigenvalues.shape))

    def modes(self, values: FloatArray) -> tuple[FloatArray, FloatArray, IntArray]:
        """Eigenvalues (m, p) [rad^2/s^2] ascending and vectors (m, p, p) in the frame, of values (e, m); and how many
        modes it has below the level of its counting (m,)."""
        logarithms, vectors = np.linalg.eigh(plain.unpacked(values[self.parts["logarithm"]], self.frame.size))
        return np.exp(logarithms) + self.shift, vectors, self._below(logarithms.T)

    def carried(self, values: FloatArray, name: str) -> FloatArray:
        """One of the carried quantities (m, ..)."""
        return values[self.parts[name]].T.reshape(-1, *self.shapes[name])

    def _below(self, logarithms: FloatArray) -> IntArray:
        if self.counting is None:
            return np.full(logarithms.shape[1], self.frame.size)
        return np.asarray((logarithms < np.log(self.counting.level - self.shift)).sum(axis=0))
