"""The box that holds the poses of a sweep, and what its coordinates are like: periodic, or mirrored at zero."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import FloatArray
from ..poses import Poses
from .spectral import Axis, Box, Kind

if TYPE_CHECKING:
    from ...kinematics import Kinematics

MOST_COORDINATES = 3  # that a tensor of nodes can have
_TURN = 2.0 * np.pi
_ROUND = 0.7  # of a turn, from which on a periodic coordinate is treated as such
_SAME = 1e-9  # m, rad
_TRIALS = 12


@dataclass(frozen=True, eq=False)
class Shape:
    """The varying coordinates of a sweep: `columns` with bounds (k, 2), the others `fixed` (d,) [m, rad].

    given: the few values that a coordinate takes, or None. periodic: whether it goes all the way round. mirror: as in
    Box.
    """

    columns: tuple[int, ...]
    bounds: FloatArray
    fixed: FloatArray
    values: tuple[FloatArray | None, ...]
    periodic: tuple[bool, ...]
    mirror: tuple[int, int] | None

    def box(self, counts: tuple[int, ...]) -> Box:
        """With so many nodes along each coordinate; a coordinate of fewer values has these for nodes."""
        axes = tuple(self._given(k, count) or self._axis(k, count) for k, count in enumerate(counts))
        return Box(axes, self.columns, self.fixed, self.mirror)

    def _given(self, k: int, count: int) -> Axis | None:
        values = self.values[k]
        if values is None or len(values) > count or self._mirrored(k):
            return None
        low, high = self.bounds[k]
        return Axis("given", low, high, len(values), values)

    def _axis(self, k: int, count: int) -> Axis:
        low, high = self.bounds[k]
        kind: Kind = "fourier" if self.periodic[k] else "chebyshev"
        even = count + count % 2
        return Axis(kind, -high if self._is_radius(k) else low, high, even if self._mirrored(k) else count)

    def _mirrored(self, k: int) -> bool:
        return self.mirror is not None and k in self.mirror

    def _is_radius(self, k: int) -> bool:
        return self.mirror is not None and k == self.mirror[0]

    @property
    def home(self) -> FloatArray:
        """The pose (d,) in the middle; a mirrored coordinate is zero there."""
        pose = self.fixed.copy()
        middle = self.bounds.mean(axis=1)
        pose[list(self.columns)] = [0.0 if self._is_radius(k) else value for k, value in enumerate(middle)]
        return pose

    def line(self, k: int, count: int) -> tuple[Axis, FloatArray]:
        """Nodes along one coordinate, and their poses (c, count, d) on lines through c corners of the others' ranges.

        Of three coordinates these are the ends of what is neither periodic nor a radius, else the upper ends only.
        """
        axis = self._axis(k, count)
        others = [i for i in range(len(self.columns)) if i != k]
        both = [len(others) > 1 and not self.periodic[i] and not self._is_radius(i) for i in others]
        ends = product(*(self.bounds[i] if each else self.bounds[i, 1:] for i, each in zip(others, both, strict=True)))
        lines = []
        for corner in ends:
            poses = np.tile(self.fixed, (axis.count, 1))
            poses[:, [self.columns[i] for i in others]] = corner
            poses[:, self.columns[k]] = axis.nodes
            lines.append(poses)
        return axis, np.array(lines)


def shape_of(kinematics: Kinematics, poses: Poses) -> Shape:
    """What varies, within which bounds, and how; tried out on the machine's kinematics."""
    columns = poses.varying()
    axes = [np.unique(poses.axes[k] if poses.points is None else poses.points[:, k]) for k in range(len(poses.names))]
    bounds = np.array([[axes[k][0], axes[k][-1]] for k in columns])
    fixed = np.array([axis[0] for axis in axes])
    trials = _trials(bounds, columns, fixed)
    periodic = tuple(
        np.ptp(bounds[i]) >= _ROUND * _TURN and _alike(kinematics, trials, trials + _TURN * _unit(k, len(fixed)))
        for i, k in enumerate(columns)
    )
    for i, turns in enumerate(periodic):
        if turns:
            bounds[i, 1] = bounds[i, 0] + _TURN
    values = tuple(axes[k] if poses.is_grid else None for k in columns)
    return Shape(columns, bounds, fixed, values, periodic, _mirror(kinematics, trials, columns, bounds, periodic))


def _mirror(
    kinematics: Kinematics,
    trials: FloatArray,
    columns: tuple[int, ...],
    bounds: FloatArray,
    periodic: tuple[bool, ...],
) -> tuple[int, int] | None:
    """Two coordinates (a, b), b periodic and a from zero on, of which (-a, b) and (a, b + half a turn) are one pose."""
    for b in (i for i, turns in enumerate(periodic) if turns):
        for a in (i for i, turns in enumerate(periodic) if not turns and bounds[i, 0] >= 0.0):
            opposite = trials.copy()
            opposite[:, columns[a]] *= -1.0
            if _alike(kinematics, opposite, trials + _TURN / 2.0 * _unit(columns[b], trials.shape[1])):
                return a, b
    return None


def _alike(kinematics: Kinematics, poses: FloatArray, others: FloatArray) -> bool:
    """Whether the machine stands alike at poses and others (N, d), as far as these can be reached; some must."""
    q, p = kinematics.solve_batch(poses).q, kinematics.solve_batch(others).q
    reached = ~np.isnan(q - p).any(axis=1)
    return bool(reached.sum() >= 3 and np.all(np.abs(q - p)[reached] < _SAME))


def _trials(bounds: FloatArray, columns: tuple[int, ...], fixed: FloatArray) -> FloatArray:
    places = np.random.default_rng(1).uniform(size=(_TRIALS, len(columns)))
    poses = np.tile(fixed, (_TRIALS, 1))
    poses[:, list(columns)] = bounds[:, 0] + places * np.ptp(bounds, axis=1) if len(columns) else poses[:, []]
    return poses


def _unit(k: int, size: int) -> FloatArray:
    return np.asarray(np.eye(size)[k])
