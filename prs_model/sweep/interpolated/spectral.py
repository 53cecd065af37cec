"""Spectral interpolation on a box of pose coordinates: nodes, weights, and how much the last terms matter.

Along a coordinate the nodes are Chebyshev's of the first kind or, where it is periodic and goes all the way round,
equally spaced; where few values are asked for, these themselves (Trefethen, Approximation Theory and Approximation
Practice, 2013; Spectral Methods in MATLAB, 2000).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from ...arrays import FloatArray, IntArray

Kind = Literal["chebyshev", "fourier", "given"]

LAST = {"chebyshev": 2, "fourier": 8, "given": 0}
"""Terms along an axis whose size says how well the rest converged; of like limbs only every n-th order may be there."""

_LAST = LAST["chebyshev"]
_ORDERS = LAST["fourier"]  # terms of four orders


@dataclass(frozen=True, eq=False)
class Axis:
    """One coordinate of the box from `low` to `high` [m, rad] with `count` nodes; `given` are the nodes themselves."""

    kind: Kind
    low: float
    high: float
    count: int
    given: FloatArray | None = None

    @cached_property
    def nodes(self) -> FloatArray:
        """(count,) ascending [m, rad]."""
        if self.given is not None:
            return self.given
        if self.kind == "fourier":
            return np.asarray(self.low + (self.high - self.low) * np.arange(self.count) / self.count)
        return np.asarray((self.low + self.high - (self.high - self.low) * np.cos(self._angles)) / 2.0)

    def weights(self, values: FloatArray) -> FloatArray:
        """(m, count): a function at `values` (m,) from its values at the nodes."""
        return np.asarray(self.terms(values) @ self.transform)

    @cached_property
    def transform(self) -> FloatArray:
        """(count, count): coefficients of the terms, slow before fast, from values at the nodes."""
        terms = self.terms(self.nodes)
        return np.asarray(terms.T / (terms**2).sum(axis=0)[:, None])

    def terms(self, values: FloatArray) -> FloatArray:
        """(m, count), none above one: Chebyshev polynomials; 1, cos, sin, cos 2 ..; or which given node it is."""
        if self.given is not None:
            return np.asarray(np.eye(self.count)[np.abs(values[:, None] - self.given).argmin(axis=1)])
        if self.kind == "chebyshev":
            place = np.clip((2.0 * values - self.low - self.high) / (self.high - self.low), -1.0, 1.0)
            return np.asarray(np.cos(np.arange(self.count) * np.arccos(-place)[:, None]))
        angle = 2.0 * np.pi * (values - self.low) / (self.high - self.low)
        orders = (np.arange(self.count) + 1) // 2
        turned = orders * angle[:, None]
        odd = np.arange(self.count) % 2 == 1
        return np.asarray(np.where(odd, np.cos(turned), np.where(orders > 0, np.sin(turned), 1.0)))

    @property
    def _angles(self) -> FloatArray:
        return np.asarray(np.pi * (2.0 * np.arange(self.count) + 1.0) / (2.0 * self.count))


@dataclass(frozen=True, eq=False)
class Box:
    """Axes of the varying coordinates, `columns` among all d, the others `fixed` (d,) [m, rad].

    mirror: positions (a, b) of two axes for which the pose at -a is that at +a with b half a turn on, such as nutation
    and precession; axis a then reaches from -high to high and only its positive half is solved for.
    """

    axes: tuple[Axis, ...]
    columns: tuple[int, ...]
    fixed: FloatArray
    mirror: tuple[int, int] | None = None

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of nodes along each axis."""
        return tuple(axis.count for axis in self.axes)

    @cached_property
    def solved(self) -> IntArray:
        """Node numbers (C order) at which the machine is solved: all, or those with the mirrored axis positive."""
        numbers = np.arange(int(np.prod(self.shape))).reshape(self.shape)
        if self.mirror is None:
            return numbers.ravel()
        half = self.axes[self.mirror[0]].count // 2
        return np.take(numbers, np.arange(half, 2 * half), axis=self.mirror[0]).ravel()

    def poses(self) -> FloatArray:
        """The poses (s, d) that are solved [m, rad]."""
        mesh = np.meshgrid(*(axis.nodes for axis in self.axes), indexing="ij")
        poses = np.tile(self.fixed, (len(self.solved), 1))
        for column, values in zip(self.columns, mesh, strict=True):
            poses[:, column] = values.ravel()[self.solved]
        return poses

    def unfold(self, values: FloatArray) -> FloatArray:
        """Values at the solved poses (s, e) as a tensor (*shape, e) over all nodes."""
        if self.mirror is None:
            return values.reshape(*self.shape, -1)
        a, b = self.mirror
        shape = list(self.shape)
        shape[a] //= 2
        half = values.reshape(*shape, -1)
        opposite = np.flip(np.roll(half, self.axes[b].count // 2, axis=b), axis=a)
        return np.concatenate([opposite, half], axis=a)

    def tail(self, tensor: FloatArray) -> tuple[float, ...]:
        """For each axis, the norm of the last terms along it, the largest on any line of nodes; 0 for given ones.

        It says how far the interpolant without these terms is off: more than the error, if the terms go on to fall.
        """
        return tuple(self._tail(k, axis, tensor) for k, axis in enumerate(self.axes))

    @staticmethod
    def _tail(k: int, axis: Axis, tensor: FloatArray) -> float:
        if axis.given is not None:
            return 0.0
        sizes = np.linalg.norm(np.tensordot(axis.transform, tensor, (1, k)), axis=-1).reshape(axis.count, -1)
        if axis.kind == "chebyshev":
            return float(sizes[-_LAST:].sum(axis=0).max())
        return 2.0 * _LAST * float(_last_order(sizes).max())

    def coefficients(self, tensor: FloatArray) -> FloatArray:
        """Of the products of terms along the axes, in the shape of the tensor; values where nodes are given."""
        for k, axis in enumerate(self.axes):
            tensor = np.moveaxis(np.tensordot(axis.transform, tensor, (1, k)), 0, k)
        return tensor

    def terms(self, tensor: FloatArray, negligible: float) -> Terms:
        """The interpolant without its smallest terms, of which no value anywhere has more than `negligible`."""
        coefficients = self.coefficients(tensor).reshape(int(np.prod(self.shape)), -1)
        sizes = np.linalg.norm(coefficients, axis=1)
        order = np.argsort(sizes)
        kept = np.sort(order[np.cumsum(sizes[order]) > negligible])
        return Terms(self, np.array(np.unravel_index(kept, self.shape)), coefficients[kept])


def _last_order(sizes: FloatArray) -> FloatArray:
    """Of terms 1, cos, sin, cos 2 .. (n, lines), what the next to last order would be if all were there.

    A machine of n like limbs may have every n-th order only. From the largest of the last four orders the terms fall on
    as they fell from the four before, by one order.
    """
    last = sizes[-_ORDERS:].max(axis=0)
    before = sizes[-2 * _ORDERS : -_ORDERS].max(axis=0, initial=0.0)
    fall = np.divide(last, before, out=np.ones_like(last), where=before > last)
    return np.asarray(last * fall**0.25)


def on_grid(tensor: FloatArray, weights: Sequence[FloatArray]) -> FloatArray:
    """(e, m_1, .., m_k) at all combinations of values with weights (m_k, n_k), from a tensor (e, n_1, .., n_k)."""
    for k in sorted(range(len(weights)), key=lambda k: len(weights[k]) / weights[k].shape[1]):
        tensor = np.moveaxis(np.tensordot(tensor, weights[k], (k + 1, 1)), -1, k + 1)
    return tensor


@dataclass(frozen=True, eq=False)
class Terms:
    """An interpolant as a sum of products of terms, one along each axis: `places` (k, t), with `factors` (t, e)."""

    box: Box
    places: IntArray
    factors: FloatArray

    def at(self, points: FloatArray) -> FloatArray:
        """Values (m, e) at points (m, d) [m, rad]."""
        product = np.ones((len(points), 1))
        for axis, column, place in zip(self.box.axes, self.box.columns, self.places, strict=True):
            product = product * axis.terms(points[:, column])[:, place]
        return np.asarray(product @ self.factors)
