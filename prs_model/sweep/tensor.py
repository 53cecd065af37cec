"""Values interpolated between nodes, at blocks of a grid or of a list."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from .poses import Poses
from .spectral import Box, Terms, on_grid
from .symmetry import Symmetry

if TYPE_CHECKING:
    from .counting import Counting

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


@dataclass(frozen=True, eq=False)
class Interpolated(Tensor):
    """A tensor that frequencies are taken from: what lies where among the e, and how far it may be off.

    error: bound of the error of what eigenvalues are taken from, anywhere. joints: those that come near a limit, whose
    values are interpolated too. symmetry: of the poses that stand for all. counting: of eigenvalues below a level, or
    None where all there are are followed.
    """

    parts: Mapping[str, slice]
    error: float
    joints: tuple[int, ...]
    symmetry: Symmetry | None
    counting: Counting | None

    @property
    def asymmetry(self) -> float:
        """What poses that stand for each other may differ by in log(lambda - shift)."""
        return 0.0 if self.symmetry is None else self.symmetry.defect


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
