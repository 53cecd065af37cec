"""The poses of a sweep worked out, as was planned: by interpolation, in a basis, or in full."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import BoolArray, FloatArray, IntArray
from .compiled import best
from .direct import solved_directly
from .enclosed.ritz_at_poses import RitzAtPoses
from .exact import part
from .in_frame import quantities_in_frame
from .interpolated.counting import Counter
from .interpolated.interpolation import Interpolation
from .interpolated.symmetry import Folded, folded
from .interpolated.tensor import Reader
from .plan_arrays import Arrays, from_arrays, to_arrays
from .planning import Found, planned
from .poses import Poses
from .quantities import BOUNDED, INTERPOLATED, UNREACHABLE, Block, Labels, blank, labels
from .reasons import reason_codes
from .request import Request

if TYPE_CHECKING:
    from ..machine import Machine

_NEAR_LIMIT = 1e-6  # m, rad: within which interpolated joint values are worked out exactly


@dataclass(frozen=True, eq=False)
class Plan:
    """A machine, its poses, what is asked, and what was found to work them out with; `why` says how that came about."""

    machine: Machine
    poses: Poses
    request: Request
    found: Found | None
    why: str

    def evaluate(self, start: int, stop: int) -> Block:
        """The results at poses start .. stop - 1. Raises PrsError for a machine that is singular in one of them."""
        if self.found is None:
            return solved_directly(self.machine, self.request, self.poses.block(start, stop), self._labels, 0.0)
        if isinstance(self.found, RitzAtPoses):
            block, frame = self._in_basis(self.found, start, stop), None
        else:
            block, frame = self._interpolated(self.found, start, stop), self.found.frame
        doubtful = np.flatnonzero(~block.pop("sure") & (block["reason"] == 0))
        if doubtful.size:
            poses, shift = self.poses.at(start + doubtful), self.found.shift
            exact = solved_directly(self.machine, self.request, poses, self._labels, shift, frame)
            for name, values in exact.items():
                block[name][doubtful] = values
        _forget(block, block["reason"] != 0)
        return block

    def _in_basis(self, found: RitzAtPoses, start: int, stop: int) -> Block:
        """Each pose worked out for itself, with whether its bounds are `sure` to be within the tolerance."""
        configurations = self.machine.kinematics.solve_batch(self.poses.block(start, stop))
        block = blank(self.request, self._labels, stop - start) | {"sure": np.zeros(stop - start, dtype=bool)}
        block["reason"] = reason_codes(self.machine.kinematics.reach, configurations.q)
        there = np.flatnonzero(block["reason"] == 0)
        if there.size:
            some = part(configurations, there)
            frequencies, bounds, complete = found.at(
                self.machine, some, self.request.n_modes, best("enclosed.kernels_ritz")
            )
            block["frequency"][there], block["bound"][there] = frequencies, bounds
            block["sure"][there] = complete & (bounds <= self.request.tolerance).all(axis=1)
        block["proof"][:] = BOUNDED
        return block

    def _interpolated(self, found: Interpolation, start: int, stop: int) -> Block:
        """By interpolation, with whether its bounds are within the tolerance and no mode is missing, `sure`."""
        first, last, places = self._folded.span(start, stop) if self._folded is not None else (start, stop, None)
        values = self._reader(first, last)
        block = self._quantities(found, values)
        joints = values[found.parts["joints"]]
        if places is not None:
            block, joints = {name: each[places] for name, each in block.items()}, joints[:, places]
        within = (block["bound"] <= self.request.tolerance).all(axis=1)
        block["sure"] = within & self._complete(block.pop("below"), start)
        block["reason"] = self._reasons(found, joints, start, stop)
        block["proof"] = np.full(stop - start, INTERPOLATED, dtype=np.int8)
        return block

    @cached_property
    def _folded(self) -> Folded | None:
        symmetry = None if not isinstance(self.found, Interpolation) else self.found.symmetry
        return None if symmetry is None else folded(symmetry, self.poses)

    @property
    def _distinct(self) -> Poses:
        """The poses that are worked out."""
        return self.poses if self._folded is None else self._folded.distinct

    @cached_property
    def _reader(self) -> Reader:
        assert isinstance(self.found, Interpolation)
        return self.found.reader(self._distinct)

    @cached_property
    def _counted(self) -> Counter | None:
        counting = None if not isinstance(self.found, Interpolation) else self.found.counting
        return None if counting is None else counting.at_most(self.poses, best("kernels"))

    def _complete(self, below: IntArray, start: int) -> BoolArray:
        """Whether none is missing of the modes asked for at the poses from `start` on, `below` (m,) of which were found
        below the level of counting. Symmetry is not relied on."""
        if self._counted is None:
            return np.ones(len(below), dtype=bool)
        most = self._counted(start, start + len(below))
        return np.asarray((most == below) & (below >= self.request.n_modes))

    def to_arrays(self) -> Arrays:
        """All but machine, poses and request, as numbers and text."""
        return to_arrays(self.found, self.why)

    @classmethod
    def from_arrays(cls, machine: Machine, poses: Poses, request: Request, arrays: Arrays) -> Plan:
        """The plan whose `to_arrays` these are."""
        return cls(machine, poses, request, *from_arrays(arrays))

    @cached_property
    def _labels(self) -> Labels:
        return labels(self.machine, self.request)

    def _quantities(self, found: Interpolation, values: FloatArray) -> Block:
        """What is asked at the poses of interpolated values (e, m), the bound of each frequency, and how many modes
        were found below the level of counting."""
        if self.request.quantities == ("frequency",):
            frequencies, bounds, below = found.frequencies(values, self.request.n_modes, best("kernels"))
            return {"frequency": frequencies, "bound": np.array(bounds), "below": below}
        eigenvalues, vectors, below = found.modes(values)
        held = {name: found.carried(values, name) for name in found.shapes}
        damping = self.machine.description.file.damping
        known = {"bound": np.array(found.bound(eigenvalues[:, : self.request.n_modes])), "below": below}
        return quantities_in_frame(eigenvalues, vectors, held, self.request, damping) | known

    def _reasons(self, found: Interpolation, joints: FloatArray, start: int, stop: int) -> NDArray[np.int16]:
        """Codes of joints beyond their limits (m,), from values (j, m) of those that come near [m, rad].

        What is near a limit is worked out exactly. Symmetry is used only where no joint comes near one.
        """
        if not found.joints:
            return np.zeros(stop - start, dtype=np.int16)
        tree = self.machine.kinematics.tree
        q = np.tile(tree.middle, (stop - start, 1))
        q[:, list(found.joints)] = joints.T
        room = np.minimum(q - tree.lower, tree.upper - q).min(axis=1)
        doubtful = np.flatnonzero(np.abs(room) < _NEAR_LIMIT)
        if doubtful.size:
            q[doubtful] = self.machine.kinematics.solve_batch(self.poses.block(start, stop)[doubtful]).q
        return reason_codes(self.machine.kinematics.reach, q)


def _forget(block: Block, unreachable: BoolArray) -> None:
    for name, values in block.items():
        if name != "reason":
            values[unreachable] = UNREACHABLE if name == "proof" else np.nan


def make_plan(machine: Machine, poses: Poses, request: Request, pool: ThreadPoolExecutor) -> Plan:
    """The plan of a sweep. Raises PrsError for what the machine cannot be asked."""
    return Plan(machine, poses, request, *planned(machine, poses, request, pool))
