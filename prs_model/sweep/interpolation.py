"""Frequencies, and what comes with them, from matrices of the smooth frame interpolated between nodes.

At each pose the interpolated L (see `frames`) is diagonalised. The interpolated Z counts the eigenvalues below the
level, so that a pose where another number of modes than p lies there, or one too near the level to tell, is told.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from ..arrays import BoolArray, FloatArray
from . import kernels as plain
from .frames import Frame
from .poses import Poses
from .spectral import Box, Terms, on_grid
from .symmetry import Symmetry

_POINTS = 512  # of a list, interpolated at once


@dataclass(frozen=True, eq=False)
class Interpolation:
    """Tensors over the nodes of a box, what lies where in their last axis, and what was proved of them.

    shapes: of the carried quantities at one pose, by name. frame: the modes that are followed together. error: bound of
    the error of log(lambda - shift) anywhere; slack: the same of Z [rad^2/s^2]. joints: those that come near a limit,
    whose values are interpolated too. symmetry: of the poses that stand for all others.
    """

    box: Box
    tensor: FloatArray
    parts: Mapping[str, slice]
    shapes: Mapping[str, tuple[int, ...]]
    frame: Frame
    error: float
    slack: float
    joints: tuple[int, ...]
    symmetry: Symmetry | None = None

    def values(self, poses: Poses, start: int, stop: int) -> FloatArray:
        """All interpolated values (e, m) at poses start .. stop - 1, poses last."""
        if poses.points is not None:
            points = poses.points[start:stop]
            chunks = [self._terms.at(points[k : k + _POINTS]) for k in range(0, len(points), _POINTS)]
            return np.ascontiguousarray(np.concatenate(chunks).T)
        axes = [poses.axes[column] for column in self.box.columns]
        leading = _leading([len(axis) for axis in axes], stop - start)
        slab = math.prod(len(axis) for axis in axes[leading:])
        values = np.empty((self.tensor.shape[-1], stop - start))
        for line in range(start // slab, -(-stop // slab)):
            low, high = max(start, line * slab), min(stop, (line + 1) * slab)
            within = slice(low - line * slab, high - line * slab)
            values[:, low - start : high - start] = self._slab(axes, leading, line, within)
        return values

    def _slab(self, axes: Sequence[FloatArray], leading: int, line: int, within: slice) -> FloatArray:
        """Values (e, m) at some of the poses of which the leading coordinates are those of a line."""
        tensor, weights = self.tensor, [axis.weights for axis in self.box.axes]
        if leading:
            places = np.unravel_index(line, [len(axis) for axis in axes[:leading]])
            for of, axis, place in zip(weights, axes, places, strict=False):
                tensor = np.tensordot(of(axis[place : place + 1])[0], tensor, 1)
        if len(axes) == leading + 1:
            return np.asarray(tensor.T @ weights[-1](axes[-1][within]).T)
        rest = [of(axis) for of, axis in zip(weights[leading:], axes[leading:], strict=True)]
        return np.asarray(on_grid(np.moveaxis(tensor, -1, 0), rest).reshape(tensor.shape[-1], -1)[:, within])

    @cached_property
    def _terms(self) -> Terms:
        return self.box.terms(self.tensor, self.error * 1e-3)

    def eigenvalues(self, values: FloatArray, kernels: Any = plain) -> FloatArray:
        """(p, m) [rad^2/s^2] ascending, of interpolated values (e, m)."""
        packed = np.ascontiguousarray(values[self.parts["logarithm"]])
        return np.asarray(np.exp(kernels.eigenvalues(packed, self.frame.size)) + self.frame.shift)

    def modes(self, values: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Eigenvalues (m, p) ascending and vectors (m, p, p) in the frame, of interpolated values (e, m)."""
        logarithms, vectors = np.linalg.eigh(plain.unpacked(values[self.parts["logarithm"]], self.frame.size))
        return np.exp(logarithms) + self.frame.shift, vectors

    def carried(self, values: FloatArray, name: str) -> FloatArray:
        """One of the carried quantities (m, ..)."""
        return values[self.parts[name]].T.reshape(-1, *self.shapes[name])

    def complete(self, values: FloatArray, kernels: Any = plain) -> BoolArray:
        """Whether exactly p eigenvalues lie below the level (m,), proved for every pose by itself."""
        if self.frame.level is None:
            return np.ones(values.shape[1], dtype=bool)
        packed = np.ascontiguousarray(values[self.parts["complement"]])
        return np.asarray(kernels.negatives(packed, self.frame.size, self.slack) == self.frame.size)


def _leading(lengths: Sequence[int], wanted: int) -> int:
    """How many of the first coordinates are gone through one by one, so that no more poses than wanted come at once."""
    return next((k for k in range(len(lengths)) if math.prod(lengths[k:]) <= wanted), len(lengths) - 1)
