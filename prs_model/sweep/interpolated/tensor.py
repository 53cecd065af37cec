"""Values interpolated between nodes, at blocks of a grid or of a list."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ...arrays import FloatArray
from ..poses import Poses
from .spectral import Box, Terms, on_grid

Reader = Callable[[int, int], FloatArray]

_POINTS = 512  # of a list, interpolated at once


@dataclass(frozen=True, eq=False)
class Tensor:
    """Values at the nodes of a box (.., e). negligible: what terms left out at the points of a list may add."""

    box: Box
    nodes: FloatArray
    negligible: float

    def reader(self, poses: Poses) -> Reader:
        """Interpolates at the poses start .. stop - 1: values (e, m), poses last."""
        if poses.points is not None:
            points, terms = poses.points, self._terms
            return lambda start, stop: np.ascontiguousarray(
                np.concatenate([terms.at(points[k : min(k + _POINTS, stop)]) for k in range(start, stop, _POINTS)]).T
            )
        axes = (poses.axes[column] for column in self.box.columns)
        weights = [axis.weights(values) for axis, values in zip(self.box.axes, axes, strict=True)]
        return lambda start, stop: _block(self._nodes_last, weights, start, stop)

    @cached_property
    def _nodes_last(self) -> FloatArray:
        return np.ascontiguousarray(np.moveaxis(self.nodes, -1, 0))

    @cached_property
    def _terms(self) -> Terms:
        return self.box.terms(self.nodes, self.negligible)


def _block(nodes: FloatArray, weights: Sequence[FloatArray], start: int, stop: int) -> FloatArray:
    """Values (e, m) at the combinations start .. stop - 1, in C order, from nodes (e, n_1, .., n_k).

    Whole lines of the first coordinate come at once; of a line that is cut only what is wanted.
    """
    if len(weights) == 1:
        return np.asarray(nodes @ weights[0][start:stop].T)
    line = math.prod(map(len, weights[1:]))
    first, last = -(-start // line), stop // line
    if first > last:
        return _on_line(nodes, weights, first - 1, start, stop, line)
    pieces = [_on_line(nodes, weights, first - 1, start, first * line, line)] if start < first * line else []
    if first < last:
        pieces.append(on_grid(nodes, [weights[0][first:last], *weights[1:]]).reshape(len(nodes), -1))
    if last * line < stop:
        pieces.append(_on_line(nodes, weights, last, last * line, stop, line))
    return np.concatenate(pieces, axis=1)


def _on_line(
    nodes: FloatArray, weights: Sequence[FloatArray], number: int, start: int, stop: int, line: int
) -> FloatArray:
    """Part of what belongs to one value of the first coordinate."""
    rest = np.tensordot(nodes, weights[0][number], (1, 0))
    return _block(rest, weights[1:], start - number * line, stop - number * line)
