"""Frequencies, and what comes with them, from matrices of the smooth frame interpolated between nodes.

At each pose the interpolated L (see `frames`) is diagonalised. The interpolated Z counts the eigenvalues below the
level, so that a pose where another number of modes than p lies there, or one too near the level to tell, is told.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import BoolArray, FloatArray
from . import kernels as plain
from .frames import Frame
from .tensor import Tensor


@dataclass(frozen=True, eq=False)
class Interpolation(Tensor):
    """A tensor of L, of Z, and of what else is carried, with shapes at one pose by name; frame: the modes of L.

    The error is that of log(lambda - shift).
    """

    frame: Frame
    shapes: Mapping[str, tuple[int, ...]]

    @property
    def level(self) -> float | None:
        """Below which eigenvalues are counted [rad^2/s^2]; None where there are no others."""
        return self.frame.level

    @property
    def counted(self) -> FloatArray:
        """The shapes (n, p) of Z."""
        return self.frame.home

    @property
    def shift(self) -> float:
        """Below all eigenvalues [rad^2/s^2]."""
        return self.frame.shift

    def frequencies(
        self, values: FloatArray, count: int, kernels: Any = plain
    ) -> tuple[FloatArray, FloatArray, BoolArray]:
        """The lowest frequencies (m, count) [Hz] of interpolated values (e, m), bounds of their relative errors, and
        whether none is missing (m,)."""
        packed = np.ascontiguousarray(values[self.parts["logarithm"]])
        shifted = np.exp(kernels.eigenvalues(packed, self.frame.size)[:count].T)
        eigenvalues = np.maximum(shifted + self.shift, 0.0)
        return np.sqrt(eigenvalues) / (2.0 * np.pi), self.bound(eigenvalues), self.complete(values, kernels)

    def bound(self, eigenvalues: FloatArray) -> FloatArray:
        """Of the relative errors of the frequencies of eigenvalues [rad^2/s^2]."""
        away = 1.0 if self.shift == 0.0 else (eigenvalues - self.shift) / np.maximum(eigenvalues, np.finfo(float).tiny)
        return np.asarray(np.broadcast_to((self.error + self.asymmetry) / 2.0 * away, eigenvalues.shape))

    def modes(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Eigenvalues (m, p) [rad^2/s^2] ascending and vectors (m, p, p) in the frame, of values (e, m)."""
        logarithms, vectors = np.linalg.eigh(plain.unpacked(values[self.parts["logarithm"]], self.frame.size))
        return np.exp(logarithms) + self.shift, vectors

    def carried(self, values: FloatArray, name: str) -> FloatArray:
        """One of the carried quantities (m, ..)."""
        return values[self.parts[name]].T.reshape(-1, *self.shapes[name])

    def complete(self, values: FloatArray, kernels: Any = plain) -> BoolArray:
        """Whether exactly p eigenvalues lie below the level (m,), proved for every pose by itself."""
        if self.frame.level is None:
            return np.ones(values.shape[1], dtype=bool)
        packed = np.ascontiguousarray(values[self.parts["complement"]])
        return np.asarray(kernels.negatives(packed, self.frame.size, self.slack) == self.frame.size)
