"""Values interpolated between nodes, at blocks of a grid or of a list."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import FloatArray
from .poses import Poses
from .spectral import Box, Terms, on_grid
from .symmetry import Symmetry

_POINTS = 512  # of a list, interpolated at once
NEGLIGIBLE = 0.02  # of the error, what terms left out at the points of a list may add


@dataclass(frozen=True, eq=False)
class Tensor:
    """Values at the nodes of a box (.., e), and what lies where among the e.

    error: bound of the error of what eigenvalues are taken from, anywhere; slack: the same of what is counted from.
    joints: those that come near a limit, whose values are interpolated too. symmetry: of the poses that stand for all.
    """

    box: Box
    nodes: FloatArray
    parts: Mapping[str, slice]
    error: float
    slack: float
    joints: tuple[int, ...]
    symmetry: Symmetry | None

    @property
    def asymmetry(self) -> float:
        """What poses that stand for each other may differ by in log(lambda - shift)."""
        return 0.0 if self.symmetry is None else self.symmetry.defect

    def values(self, poses: Poses, start: int, stop: int) -> FloatArray:
        """All interpolated values (e, m) at poses start .. stop - 1, poses last."""
        if poses.points is not None:
            points = poses.points[start:stop]
            chunks = [self._terms.at(points[k : k + _POINTS]) for k in range(0, len(points), _POINTS)]
            return np.ascontiguousarray(np.concatenate(chunks).T)
        axes = [poses.axes[column] for column in self.box.columns]
        leading = _leading([len(axis) for axis in axes], stop - start)
        slab = math.prod(len(axis) for axis in axes[leading:])
        values = np.empty((self.nodes.shape[-1], stop - start))
        for line in range(start // slab, -(-stop // slab)):
            low, high = max(start, line * slab), min(stop, (line + 1) * slab)
            within = slice(low - line * slab, high - line * slab)
            values[:, low - start : high - start] = self._slab(axes, leading, line, within)
        return values

    def _slab(self, axes: Sequence[FloatArray], leading: int, line: int, within: slice) -> FloatArray:
        """Values (e, m) at some of the poses of which the leading coordinates are those of a line."""
        nodes, weights = self.nodes, [axis.weights for axis in self.box.axes]
        if leading:
            places = np.unravel_index(line, [len(axis) for axis in axes[:leading]])
            for of, axis, place in zip(weights, axes, places, strict=False):
                nodes = np.tensordot(of(axis[place : place + 1])[0], nodes, 1)
        if len(axes) == leading + 1:
            return np.asarray(nodes.T @ weights[-1](axes[-1][within]).T)
        rest = [of(axis) for of, axis in zip(weights[leading:], axes[leading:], strict=True)]
        return np.asarray(on_grid(np.moveaxis(nodes, -1, 0), rest).reshape(nodes.shape[-1], -1)[:, within])

    @cached_property
    def _terms(self) -> Terms:
        return self.box.terms(self.nodes, self.error * NEGLIGIBLE)


def _leading(lengths: Sequence[int], wanted: int) -> int:
    """How many of the first coordinates are gone through one by one, so that no more poses than wanted come at once."""
    return next((k for k in range(len(lengths)) if math.prod(lengths[k:]) <= wanted), len(lengths) - 1)
