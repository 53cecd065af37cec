"""Poses that are alike because the limbs are: tested on the machine at hand, then used for its frequencies.

A machine of n like limbs may have the same frequencies when a periodic coordinate goes on by an n-th of its turn, and
at poses that lie opposite each other about a plane through a limb. Meshes and reductions break that a little: what was
found is used if it is small beside the tolerance, and counts as an error.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ...arrays import FloatArray
from ..poses import Poses
from .box_of import Shape

_TURN = 2.0 * np.pi
_TRIALS = 8  # poses that are compared with their images
_PLANES = 4  # candidates for a plane of reflection, a quarter of the period apart
_SAFETY = 1.5  # on the largest difference of a few poses
_WORTH = 0.5  # of the tolerance, that the difference may take
_SAME = 1e-11  # rad, of coordinates that are one

Logarithms = Callable[[FloatArray], FloatArray]
"""Logarithms of the eigenvalues asked for (N, k) at poses (N, d)."""


@dataclass(frozen=True)
class Symmetry:
    """Poses alike under `column` + period, and where `plane` is a value of it [rad], at plane + x and plane - x.

    defect: bound of the differences of log(lambda - shift) between such poses.
    """

    column: int
    period: float
    plane: float | None
    start: float
    defect: float

    def folded(self, values: FloatArray) -> FloatArray:
        """Values of the coordinate [rad] brought into one period, or into the half of it that the plane leaves."""
        if self.plane is None:
            return np.asarray(self.start + np.mod(values - self.start, self.period))
        away = np.mod(values - self.plane, self.period)
        return np.asarray(self.plane + np.minimum(away, self.period - away))

    def images(self, poses: FloatArray) -> FloatArray:
        """All poses (.., d) that are alike to some of poses (N, d)."""
        values, turns = poses[:, self.column], np.arange(round(_TURN / self.period))
        every = [values] if self.plane is None else [values, 2.0 * self.plane - values]
        result = []
        for alike in (each + turn * self.period for each in every for turn in turns):
            result.append(poses.copy())
            result[-1][:, self.column] = alike
        return np.concatenate(result)


@dataclass(frozen=True, eq=False)
class Folded:
    """Poses in place of which `distinct` ones are worked out; `places` (m,) say which along the axis of a grid."""

    poses: Poses
    distinct: Poses
    column: int
    places: NDArray[np.intp] | None

    def span(self, start: int, stop: int) -> tuple[int, int, NDArray[np.intp]]:
        """Distinct poses first .. last - 1 that stand for start .. stop - 1, and which of them each is (m,)."""
        numbers = np.arange(start, stop)
        if self.places is not None:
            where = list(np.unravel_index(numbers, self.poses.shape))
            where[self.column] = self.places[where[self.column]]
            numbers = np.ravel_multi_index(where, self.distinct.shape)
        first = int(numbers.min())
        return first, int(numbers.max()) + 1, numbers - first


def folded(symmetry: Symmetry, poses: Poses) -> Folded:
    """The poses, and those in one period that stand for them."""
    column = symmetry.column
    if poses.points is not None:
        points = poses.points.copy()
        points[:, column] = symmetry.folded(points[:, column])
        return Folded(poses, Poses(poses.names, (), points), column, None)
    values = symmetry.folded(poses.axes[column])
    order = np.argsort(values)
    new = np.concatenate([[True], np.diff(values[order]) > _SAME])
    places = np.empty(len(values), dtype=np.intp)
    places[order] = np.cumsum(new) - 1
    axes = tuple(values[order][new] if k == column else axis for k, axis in enumerate(poses.axes))
    return Folded(poses, Poses(poses.names, axes), column, places)


def symmetry_of(shape: Shape, likes: set[int], tolerance: float, logarithms: Logarithms) -> Symmetry | None:
    """The symmetry of a machine with so many like limbs over the poses, or none. tolerance: of frequencies."""
    turning = [column for column, turns in zip(shape.columns, shape.periodic, strict=True) if turns]
    if not turning or not likes:
        return None
    column, period = turning[0], _TURN / max(likes)
    trials = _trials(shape)
    values, most = trials[:, column], 2.0 * tolerance * _WORTH

    def at(images: FloatArray, poses: FloatArray = trials) -> FloatArray:
        moved = poses.copy()
        moved[:, column] = images
        return logarithms(moved)

    def differ(some: FloatArray, others: FloatArray) -> float:
        return _SAFETY * float(np.abs(some - others).max())

    exact, turned = np.split(at(np.concatenate([values, values + period]), np.tile(trials, (2, 1))), 2)
    defect = differ(turned, exact)
    if defect > most:
        return None
    start = float(shape.bounds[shape.columns.index(column), 0])
    planes = period / _PLANES * np.arange(_PLANES) / 2.0
    reflected = at(2.0 * planes - values[0], np.tile(trials[:1], (_PLANES, 1)))
    for plane in (plane for plane, one in zip(planes, reflected, strict=True) if differ(one, exact[0]) < most):
        if (both := defect + differ(at(2.0 * plane - values), exact)) < most:
            return Symmetry(column, period, float(plane), start, both)
    return Symmetry(column, period, None, start, defect)


def _trials(shape: Shape) -> FloatArray:
    places = np.random.default_rng(4).uniform(size=(_TRIALS, len(shape.columns)))
    far = [not turns for turns in shape.periodic]
    places[: _TRIALS // 2, far] **= 0.25  # most at the far ends, where differences are largest
    poses = np.tile(shape.fixed, (_TRIALS, 1))
    poses[:, list(shape.columns)] = shape.bounds[:, 0] + places * np.ptp(shape.bounds, axis=1)
    return poses
