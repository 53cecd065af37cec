"""The poses of a sweep: a grid over the pose coordinates, or a list."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import prod
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError
from ..plugins import unknown

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..machine import Machine

_LARGEST = 1e6  # m, rad: beyond it no digit of an angle is left


@dataclass(frozen=True, eq=False)
class Poses:
    """Poses in the order of the task's coordinates [m, rad], numbered in C order.

    A grid has `axes`, one array of values per coordinate, of length 1 where it is fixed; a list has `points` (N, d).
    """

    names: tuple[str, ...]
    axes: tuple[FloatArray, ...]
    points: FloatArray | None = None

    @property
    def is_grid(self) -> bool:
        """Whether the poses are all combinations of the axes."""
        return self.points is None

    @property
    def shape(self) -> tuple[int, ...]:
        """One length per coordinate of a grid, fixed ones included; (N,) of a list."""
        return tuple(map(len, self.axes)) if self.points is None else (len(self.points),)

    @property
    def size(self) -> int:
        """How many poses there are."""
        return prod(self.shape)

    def block(self, start: int, stop: int) -> FloatArray:
        """Poses start .. stop - 1 (m, d) [m, rad]."""
        return self.at(np.arange(start, min(stop, self.size)))

    def at(self, numbers: ArrayLike) -> FloatArray:
        """The poses of these numbers (m, d) [m, rad]."""
        numbers = np.asarray(numbers, dtype=np.intp)
        if self.points is not None:
            return np.asarray(self.points[numbers])
        places = np.unravel_index(numbers, self.shape) if self.axes else ()
        columns = [axis[place] for axis, place in zip(self.axes, places, strict=True)]
        return np.array(columns).reshape(len(columns), len(numbers)).T.copy()

    def varying(self) -> tuple[int, ...]:
        """The coordinates (their numbers) of which more than one value occurs."""
        values = self.axes if self.points is None else self.points.T
        return tuple(k for k, each in enumerate(values) if len(each) and np.ptp(each) > 0.0)


def poses_of(machine: Machine, coordinates: Mapping[str, ArrayLike], poses: ArrayLike | None = None) -> Poses:
    """A grid of the values given for each coordinate, one or a list of them [m, rad], or the list `poses` (N, d).

    Coordinates left out of a grid keep their reference values. Raises PrsError for a coordinate the machine does not
    have, a list that is empty, not one-dimensional or holds what is no number, or a grid and a list at once.
    """
    names = machine.pose_names
    if poses is not None:
        if coordinates:
            given = ", ".join(coordinates)
            raise PrsError(f"sweep: found a list of poses and values of {given}; expected one of the two")
        return Poses(names, (), _listed(names, poses))
    for name in coordinates:
        if name not in names:
            raise unknown("pose coordinate", name, list(names))
    given_or_reference = {**machine.reference_pose, **coordinates}
    return Poses(names, tuple(_axis(name, given_or_reference[name]) for name in names))


def _axis(name: str, values: ArrayLike) -> FloatArray:
    expected = "expected a number or a list of numbers [m, rad]"
    axis = np.atleast_1d(_numbers(name, values, expected))
    if axis.ndim != 1 or not axis.size:
        found = "an empty list" if not axis.size else f"an array of shape {axis.shape}"
        raise PrsError(f"{name}: found {found}, {expected}")
    wrong = np.flatnonzero(~(np.abs(axis) <= _LARGEST))
    if wrong.size:
        raise PrsError(f"{name}: found {axis[wrong[0]]:g} at place {wrong[0]}, {_within()}")
    return axis


def _listed(names: tuple[str, ...], poses: ArrayLike) -> FloatArray:
    expected = f"expected (N, {len(names)}): {', '.join(names)} [m, rad]"
    points = _numbers("poses", poses, expected)
    if points.ndim != 2 or points.shape[1] != len(names) or not len(points):
        raise PrsError(f"poses: found an array of shape {points.shape}, {expected}")
    wrong = np.argwhere(~(np.abs(points) <= _LARGEST))
    if wrong.size:
        i, k = wrong[0]
        raise PrsError(f"poses: found {points[i, k]:g} for {names[k]} of pose {i}, {_within()}")
    return points


def _numbers(name: str, values: ArrayLike, expected: str) -> FloatArray:
    """A copy as floating-point numbers."""
    try:
        found = np.asarray(values)
        if found.dtype.kind not in "iuf":
            raise TypeError(f"values of type {found.dtype}")
        return np.array(found, dtype=float)
    except (TypeError, ValueError) as error:
        raise PrsError(f"{name}: found no array of numbers ({error}), {expected}") from error


def _within() -> str:
    return f"expected a number between -{_LARGEST:,.0f} and {_LARGEST:,.0f} [m, rad]"
