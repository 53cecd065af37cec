"""Making an interpolation for a sweep: how many nodes it needs, and trials of what it says."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import FloatArray
from ..exact import Solved, Solver, eigenvalues_of
from ..kernels import as_frobenius
from ..not_smooth import NotSmoothError
from ..poses import Poses
from ..request import Request
from .box_of import MOST_COORDINATES, Shape, shape_of
from .convergence import Need, need
from .counting import Counting, counting
from .following import Following, following
from .interpolation import Interpolation
from .joint_values import JointValues, joint_values
from .spectral import Box
from .symmetry import Logarithms, Symmetry, folded, symmetry_of

if TYPE_CHECKING:
    from ...machine import Machine

_LINE = (17, 33, 65, 129)  # nodes of the lines on which convergence is tried
_BEYOND = 1.5  # times as many nodes as a line has, which may be reckoned from it
_COARSE = 9  # nodes along each axis, at which joints are held against their limits
_SHARE = 1.4  # of the error allowed over the square of the number of axes, for what a line leaves out
_AMPLE = 2.0  # times what the error is too large by, to be made up for with more nodes
_TAKES_PART = 0.2  # of the longest tail: an axis whose own is shorter needs no more
_ATTEMPTS = 8
_HELD_OUT = 24
_SHARES_OF_GAP = (0.5, 0.3, 0.7)  # where modes are counted
_ROOM = 0.1  # of the range of a joint's values at the nodes, by which it may go further in between
_LIMIT_SLACK = 1e-6  # m, rad
_NEGLIGIBLE = 0.02  # of the error, what terms left out at the points of a list may add
_ROUNDING = 1e-11  # of a frequency


def interpolated(
    machine: Machine, poses: Poses, request: Request, solver: Solver, pool: ThreadPoolExecutor, most_nodes: float
) -> tuple[Interpolation, str]:
    """An interpolation whose frequencies are within the tolerance at nearly every pose, and in words what was found.

    Raises NotSmoothError where there is none or it needs too many nodes, or PrsError for nodes out of reach.
    """
    varying = len(poses.varying())
    if varying not in range(1, MOST_COORDINATES + 1):
        raise NotSmoothError(f"{varying} coordinates vary, more than {MOST_COORDINATES}")
    shape = shape_of(machine.kinematics, poses)
    return _Planner(machine, poses, poses, request, pool, shape, solver, most_nodes).by_symmetry().plan()


@dataclass(frozen=True, eq=False)
class _Planner:
    """asked: the poses of the sweep; poses: those that stand for all of them. most_nodes: that pay."""

    machine: Machine
    asked: Poses
    poses: Poses
    request: Request
    pool: ThreadPoolExecutor
    shape: Shape
    solver: Solver
    most_nodes: float
    symmetry: Symmetry | None = None

    @cached_property
    def _joints(self) -> JointValues:
        return joint_values(self.machine.kinematics, self.poses)

    def by_symmetry(self) -> _Planner:
        """With fewer poses, if the machine is symmetric and no joint comes near its limits; frequencies only."""
        if self.request.quantities != ("frequency",):
            return self
        few = replace(self.solver, count=self.request.n_modes)
        logarithms = _logarithms(few, self.request, self.pool)
        found = symmetry_of(self.shape, _like_limbs(self.machine), self.request.tolerance, logarithms)
        if found is None:
            return self
        poses = folded(found, self.asked).distinct
        shape = shape_of(self.machine.kinematics, poses)
        return (
            self if self._comes_near_limits(shape, found) else replace(self, poses=poses, shape=shape, symmetry=found)
        )

    def plan(self) -> tuple[Interpolation, str]:
        """The interpolation, and what was found in words."""
        home = next(self.solver.each(self.shape.home[None], _kept, self.pool))
        lines = [self._line(k, _LINE[0]) for k in range(len(self.shape.columns))]
        values = eigenvalues_of([each for line in lines for each in line])
        return self._fitted(following(self.request, self.solver, home, values), lines)

    def _line(self, k: int, count: int) -> list[Solved]:
        poses = self.shape.line(k, count)[1]
        return list(self.solver.each(poses.reshape(-1, poses.shape[-1]), _kept, self.pool))

    def _fitted(self, modes: Following, lines: list[list[Solved]]) -> tuple[Interpolation, str]:
        """The interpolation of modes, from lines solved already, with more nodes until its error is small."""
        planner = replace(self, solver=replace(self.solver, count=modes.count))
        taken = 0.0 if self.symmetry is None else self.symmetry.defect / (2.0 * self.request.tolerance)
        most = 2.0 * self.request.tolerance * (1.0 - taken)
        needs = [planner._need(modes, k, line, most) for k, line in enumerate(lines)]
        counts = tuple(each.count for each in needs)
        self._check_pays(counts)
        with ThreadPoolExecutor(1) as aside:
            counted = aside.submit(planner._counting, modes)
            found, words = planner._with_enough_nodes(modes, counts, needs, most)
            return replace(found, counting=counted.result()), words

    def _check_pays(self, counts: tuple[int, ...]) -> None:
        """Raises NotSmoothError where these nodes are too many."""
        nodes = len(self.shape.box(counts).solved)
        if nodes > self.most_nodes:
            raise NotSmoothError(f"{nodes} nodes would be needed for {self.poses.size} poses")

    def _with_enough_nodes(
        self, modes: Following, counts: tuple[int, ...], needs: list[Need], most: float
    ) -> tuple[Interpolation, str]:
        for _ in range(_ATTEMPTS):
            self._check_pays(counts)
            box = self.shape.box(counts)
            found, tails = self._interpolation(modes, box)
            at_nodes = self.machine.kinematics.solve_batch(box.poses()).q
            if found.error <= most and self._joints.are_met_by(box, at_nodes):
                share, worst = self._held_out(found)
                if worst is not None:
                    return found, self._in_words(found, modes, share, worst)
            excess = _AMPLE * max(found.error / most, 1.0)
            counts = tuple(
                each.more(count, excess) if tail > _TAKES_PART * max(tails) else count
                for each, count, tail in zip(needs, box.shape, tails, strict=True)
            )
        raise NotSmoothError(f"{len(box.solved)} nodes are not enough")

    def _need(self, modes: Following, k: int, solved: list[Solved], most: float) -> Need:
        """Nodes along coordinate k for which the last terms along lines have a small share of the error allowed."""
        most *= _SHARE / len(self.shape.columns) ** 2
        beyond = _BEYOND if len(self.shape.columns) < MOST_COORDINATES else 1.0  # a box of nodes outweighs many lines
        for count in _LINE:
            axis, poses = self.shape.line(k, count)
            if count > _LINE[0]:
                solved = self._line(k, count)
            matrices = np.concatenate([as_frobenius(modes.on_line(each)) for each in solved])
            if found := need(axis, matrices.reshape(*poses.shape[:2], -1), most, beyond):
                return found
        raise NotSmoothError(f"{self.poses.names[self.shape.columns[k]]}: {axis.count} nodes along it are not enough")

    def _interpolation(self, modes: Following, box: Box) -> tuple[Interpolation, tuple[float, ...]]:
        """The interpolation on a box, and the error that is due to each of its axes."""

        def at_nodes(solved: Solved) -> dict[str, FloatArray]:
            return modes.at_nodes(solved) | {"joints": solved.configurations.q}

        chunks = list(self.solver.each(box.poses(), at_nodes, self.pool))
        values = {name: np.concatenate([chunk[name] for chunk in chunks]) for name in chunks[0]}
        joints = self._near_limits(values["joints"])
        values["joints"] = values["joints"][:, joints]
        flat = {name: each.reshape(len(each), -1) for name, each in values.items()}
        stops = np.cumsum([each.shape[1] for each in flat.values()]).tolist()
        parts = {
            name: slice(stop - each.shape[1], stop) for (name, each), stop in zip(flat.items(), stops, strict=True)
        }
        nodes = box.unfold(np.hstack(list(flat.values())))
        tails = box.tail(as_frobenius(nodes[..., parts["logarithm"]]))
        error = (1.0 + _NEGLIGIBLE) * sum(tails)
        found = modes.interpolation(
            {name: each.shape[1:] for name, each in values.items()},
            box=box,
            nodes=nodes,
            parts=parts,
            negligible=_NEGLIGIBLE * error,
            error=error,
            joints=tuple(joints),
            symmetry=self.symmetry,
            counting=None,
        )
        return found, tails

    def _counting(self, modes: Following) -> Counting | None:
        """At the level in the gap that serves, None where all modes are followed. Raises NotSmoothError."""
        shape, refused = shape_of(self.machine.kinematics, self.asked), NotSmoothError()
        for share in _SHARES_OF_GAP:
            if (level := modes.level(share)) is None:
                return None
            try:
                return counting(self.solver, shape, self.asked, level, self.pool)
            except NotSmoothError as error:
                refused = error
        raise refused

    def _comes_near_limits(self, shape: Shape, symmetry: Symmetry) -> bool:
        """Whether a joint does somewhere, among all poses that are alike: limbs may be alike but for their limits."""
        poses = symmetry.images(shape.box((_COARSE,) * len(shape.columns)).poses())
        q = self.machine.kinematics.solve_batch(poses).q
        return bool(np.isnan(q).any() or self._near_limits(q))

    def _near_limits(self, joints: FloatArray) -> list[int]:
        """The joints that come near a limit somewhere, from their values at the nodes (N, j) [m, rad]."""
        tree = self.machine.kinematics.tree
        low, high = joints.min(axis=0), joints.max(axis=0)
        room = _ROOM * (high - low) + _LIMIT_SLACK
        return [int(j) for j in np.flatnonzero((low - room < tree.lower) | (high + room > tree.upper))]

    def _held_out(self, found: Interpolation) -> tuple[float, float | None]:
        """Of some of the poses, solved exactly: the share whose bound is within the tolerance, and their largest error.

        No error where one is larger than its bound, or less than half of the poses are within the tolerance.
        """
        drawn = np.random.default_rng(2).choice(self.asked.size, _HELD_OUT, replace=False)
        numbers = sorted({*drawn.tolist(), *_corners(self.asked)})
        poses = self.asked.at(numbers)
        poses = poses[self.machine.kinematics.solve_batch(poses).reachable]
        if not len(poses):
            raise NotSmoothError("none of the poses that were tried is within reach")
        exact = np.exp(_logarithms(self.solver, self.request, self.pool)(poses)) + self.solver.shift
        if self.symmetry is not None:
            poses[:, self.symmetry.column] = self.symmetry.folded(poses[:, self.symmetry.column])
        values = found.reader(Poses(self.asked.names, (), poses))(0, len(poses))
        frequencies, bounds, _ = found.frequencies(values, self.request.n_modes)
        errors = np.abs(frequencies / (np.sqrt(np.maximum(exact, np.finfo(float).tiny)) / (2.0 * np.pi)) - 1.0)
        sure = (bounds <= self.request.tolerance).all(axis=1)
        if np.any(errors[sure] > bounds[sure] + _ROUNDING) or sure.mean() < 0.5:
            return float(sure.mean()), None
        return float(sure.mean()), float(errors[sure].max())

    def _in_words(self, found: Interpolation, modes: Following, share: float, worst: float) -> str:
        nodes = f"{len(found.box.solved)} nodes ({' x '.join(map(str, found.box.shape))})"
        alike = "" if self.symmetry is None else f"; symmetric within {self.symmetry.defect / 2.0:.1e}"
        sure = "" if share == 1.0 else f", {share:.0%} of which it covers"
        checked = f"largest error at the corners and {_HELD_OUT} poses, solved exactly{sure}, {worst:.1e}"
        return f"{nodes}, {modes.words()}{alike}; {checked}"


def _corners(poses: Poses) -> set[int]:
    """The numbers of the poses at the corners of a grid; the first and the last of a list."""
    ends = [(0, length - 1) for length in poses.shape]
    return {int(np.ravel_multi_index(corner, poses.shape)) for corner in product(*ends)}


def _like_limbs(machine: Machine) -> set[int]:
    """How many instances the groups of like parts of a machine have."""
    return {len(instances) for instances in machine.description.file.symmetry.values()}


def _logarithms(solver: Solver, request: Request, pool: ThreadPoolExecutor) -> Logarithms:
    def logarithms(poses: FloatArray) -> FloatArray:
        exact = eigenvalues_of(list(solver.each(poses, _kept, pool)))
        return np.asarray(np.log(exact[:, : request.n_modes] - solver.shift))

    return logarithms


def _kept(solved: Solved) -> Solved:
    return solved
