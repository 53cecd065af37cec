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

    def weights(self, poses: Poses) -> list[FloatArray]:
        """Along each axis of the box those of a grid's values (m_k, n_k)."""
        axes = (poses.axes[column] for column in self.box.columns)
        return [axis.weights(values) for axis, values in zip(self.box.axes, axes, strict=True)]

    def values(self, poses: Poses, start: int, stop: int, weights: Sequence[FloatArray] | None = None) -> FloatArray:
        """All interpolated values (e, m) at poses start .. stop - 1, poses last. weights: of a grid, if known."""
        if poses.points is not None:
            points = poses.points[start:stop]
            chunks = [self._terms.at(points[k : k + _POINTS]) for k in range(0, len(points), _POINTS)]
            return np.ascontiguousarray(np.concatenate(chunks).T)
        return _block(self._nodes_last, weights or self.weights(poses), start, stop)

    @cached_property
    def _nodes_last(self) -> FloatArray:
        return np.ascontiguousarray(np.moveaxis(self.nodes, -1, 0))

    @cached_property
    def _terms(self) -> Terms:
        return self.box.terms(self.nodes, self.error * NEGLIGIBLE)


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
