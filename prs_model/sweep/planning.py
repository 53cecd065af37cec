"""Making an interpolation for a sweep: which modes, how many nodes, and the proof that they are enough."""

from __future__ import annotations

import logging
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError
from ..linear_algebra import positive_definite_pencil
from .box_of import MOST_COORDINATES, Shape, shape_of
from .exact import Solved, Solver
from .frames import Frame, in_frame
from .in_frame import carried, is_possible, reaches
from .interpolation import Interpolation
from .poses import Poses
from .request import Request
from .spectral import Box
from .symmetry import Logarithms, Symmetry, folded, symmetry_of

if TYPE_CHECKING:
    from ..machine import Machine
    from ..synthesis import System

_log = logging.getLogger("prs_model")

_FEWEST = 400  # poses that are worth an interpolation
_EXTRA = 9  # modes above those asked for, among which a gap is sought
_LEAST_GAP = 1.04  # ratio of eigenvalues above and below it
_GOOD_GAP = 1.1
_LEAST_ALIGNMENT = 0.3
_LINE = (17, 33, 65, 129)  # nodes of the lines on which convergence is tried
_ENLARGED = 1.2  # more nodes along an axis whose tail is too long
_ATTEMPTS = 4
_HELD_OUT = 24
_SHARE = 0.2  # of the error allowed, for what a line leaves out
_ROOM = 0.1  # of the range of a joint's values at the nodes, by which it may go further in between
_OWN = ("logarithm", "complement", "joints")  # what is not carried for the quantities asked for
_LIMIT_SLACK = 1e-6  # m, rad: interpolated joint values nearer than this to a limit are worked out


class _NotSmoothError(Exception):
    """Why an interpolation does not serve, in words."""


def interpolated(
    machine: Machine, poses: Poses, request: Request, pool: ThreadPoolExecutor
) -> tuple[Interpolation | None, str]:
    """An interpolation whose frequencies are within the tolerance at every pose, or none; and what was found in words.

    None where the poses are few or more than three coordinates vary, where the subspace is not smooth, or where a node
    is out of reach.
    """
    if poses.size < _FEWEST:
        return None, f"{poses.size} poses are solved one by one"
    if len(poses.varying()) not in range(1, MOST_COORDINATES + 1):
        return None, f"{len(poses.varying())} coordinates vary, more than {MOST_COORDINATES}"
    if not is_possible(request, machine.description.file.damping):
        return None, "resonance peaks under damping of joints"
    try:
        return _Planner.of(machine, poses, request, pool).plan()
    except (_NotSmoothError, PrsError) as error:
        return None, str(error)


@dataclass(frozen=True, eq=False)
class _Planner:
    machine: Machine
    asked: Poses
    poses: Poses
    request: Request
    pool: ThreadPoolExecutor
    shape: Shape
    solver: Solver
    symmetry: Symmetry | None

    @classmethod
    def of(cls, machine: Machine, poses: Poses, request: Request, pool: ThreadPoolExecutor) -> _Planner:
        shape = shape_of(machine.kinematics, poses)
        home = machine.assemble(machine.kinematics.solve_batch(shape.home[None])[0])
        shift, _ = positive_definite_pencil(home.mass, home.stiffness)
        solver = Solver(machine, _modes_needed(home, request), shift)
        found, distinct = None, poses
        if request.quantities == ("frequency",):
            found = symmetry_of(shape, _like_limbs(machine), request.tolerance, _logarithms(solver, request, pool))
        if found is not None:
            distinct = folded(found, poses).distinct
            shape = shape_of(machine.kinematics, distinct)
        return cls(machine, poses, distinct, request, pool, shape, solver, found)

    def plan(self) -> tuple[Interpolation, str]:
        home = next(self.solver.each(self.shape.home[None], _kept, self.pool))
        lines = [self._line(k, _LINE[0]) for k in range(len(self.shape.columns))]
        frame = self._frame(home, np.concatenate([each.modes.eigenvalues for line in lines for each in line]))
        return replace(self, solver=replace(self.solver, count=frame.size + 1))._with(frame, lines)

    def _with(self, frame: Frame, lines: list[list[Solved]]) -> tuple[Interpolation, str]:
        """The interpolation of matrices in a frame, from lines solved already."""
        counts = tuple(self._count(frame, k, line) for k, line in enumerate(lines))
        for _ in range(_ATTEMPTS):
            box = self.shape.box(counts)
            if len(box.solved) > self.poses.size / 2:
                raise _NotSmoothError(f"{len(box.solved)} nodes would be needed for {self.poses.size} poses")
            found, tails = self._interpolation(frame, box)
            if found.error <= 2.0 * self.request.tolerance:
                worst = self._held_out(found)
                if worst <= found.error:
                    return found, self._in_words(found, worst)
                tails = tuple(tail + worst for tail in tails)
            counts = tuple(_more(count, tail, max(tails)) for count, tail in zip(box.shape, tails, strict=True))
        raise _NotSmoothError(f"{len(box.solved)} nodes leave an error of {found.error / 2.0:.1e}")

    def _line(self, k: int, count: int) -> list[Solved]:
        return list(self.solver.each(self.shape.line(k, count)[1], _kept, self.pool))

    def _frame(self, home: Solved, eigenvalues: FloatArray) -> Frame:
        """The frame with the smallest number of modes above which there is a good gap, or else with the widest."""
        n, available = self.request.n_modes, eigenvalues.shape[1]
        if available < self.solver.count:
            return Frame(home.modes.shapes[0], self.solver.shift, None)
        shifted = eigenvalues - self.solver.shift
        gaps = shifted[:, n:].min(axis=0) / shifted[:, n - 1 : -1].max(axis=0)
        numbers = np.arange(n, n + len(gaps))
        left_out = np.sqrt(np.maximum(eigenvalues.min(axis=0)[n:], 0.0)) / (2.0 * np.pi)
        enough = np.array([reaches(self.request, each) for each in left_out.tolist()])
        if not enough.any():
            raise _NotSmoothError("the band reaches beyond the modes that are followed")
        gaps = np.where(enough, gaps, 0.0)
        p = int(numbers[np.argmax(gaps > _GOOD_GAP) if gaps.max() > _GOOD_GAP else np.argmax(gaps)])
        if gaps.max() < _LEAST_GAP:
            raise _NotSmoothError(f"no gap above any of modes {n} to {numbers[-1]}")
        below, above = shifted[:, p - 1].max(), shifted[:, p].min()
        return Frame(home.modes.shapes[0][:, :p], self.solver.shift, float(np.sqrt(below * above)) + self.solver.shift)

    def _count(self, frame: Frame, k: int, solved: list[Solved]) -> int:
        """Nodes along coordinate k for which the last terms along a line are small enough."""
        wanted = 2.0 * self.request.tolerance * _SHARE / len(self.shape.columns)
        for count in _LINE:
            axis, _ = self.shape.line(k, count)
            if axis.given is not None:
                return axis.count
            if count > _LINE[0]:
                solved = self._line(k, count)
            matrices = np.concatenate([_frame_matrices(frame, each)["logarithm"] for each in solved])
            sizes = np.linalg.norm(axis.transform @ matrices, axis=1)
            rest = np.cumsum(sizes[::-1])[::-1]
            if rest[-4] < wanted:
                return int(np.flatnonzero(rest < wanted)[0]) + 2
        raise _NotSmoothError(f"{self.poses.names[self.shape.columns[k]]}: {axis.count} nodes along it are not enough")

    def _interpolation(self, frame: Frame, box: Box) -> tuple[Interpolation, tuple[float, ...]]:
        """The interpolation on a box, and the error of the logarithms that is due to each of its axes."""
        chunks = list(self.solver.each(box.poses(), lambda solved: self._at_nodes(frame, solved), self.pool))
        found = {name: np.concatenate([chunk[name] for chunk in chunks]) for name in chunks[0]}
        joints = self._near_limits(found["joints"])
        found["joints"] = found["joints"][:, joints]
        shapes = {name: each.shape[1:] for name, each in found.items()}
        flat = {name: each.reshape(len(each), -1) for name, each in found.items()}
        stops = np.cumsum([each.shape[1] for each in flat.values()]).tolist()
        parts = {
            name: slice(stop - each.shape[1], stop) for (name, each), stop in zip(flat.items(), stops, strict=True)
        }
        tensor = box.unfold(np.hstack(list(flat.values())))
        tails = box.tail(tensor[..., parts["logarithm"]])
        slack = 2.0 * sum(box.tail(tensor[..., parts["complement"]])) if frame.level is not None else 0.0
        carries = {name: shape for name, shape in shapes.items() if name not in _OWN}
        error = sum(tails) + (self.symmetry.defect if self.symmetry is not None else 0.0)
        return Interpolation(box, tensor, parts, carries, frame, error, slack, tuple(joints), self.symmetry), tails

    def _at_nodes(self, frame: Frame, solved: Solved) -> dict[str, FloatArray]:
        matrices = _frame_matrices(frame, solved)
        frames = matrices.pop("frames")
        only = self.request.quantities == ("frequency",)
        more = {} if only else carried(solved.systems, frames, self.request)
        return {**matrices, **more, "joints": solved.configurations.q}

    def _near_limits(self, joints: FloatArray) -> list[int]:
        """The joints that come near a limit somewhere, from their values at the nodes (N, j) [m, rad]."""
        tree = self.machine.kinematics.tree
        low, high = joints.min(axis=0), joints.max(axis=0)
        room = _ROOM * (high - low) + _LIMIT_SLACK
        return [int(j) for j in np.flatnonzero((low - room < tree.lower) | (high + room > tree.upper))]

    def _held_out(self, found: Interpolation) -> float:
        """The largest error of a logarithm at some of the poses asked for, solved exactly."""
        numbers = np.sort(np.random.default_rng(2).choice(self.asked.size, _HELD_OUT, replace=False))
        poses = np.concatenate([self.asked.block(i, i + 1) for i in numbers.tolist()])
        exact = _logarithms(self.solver, self.request, self.pool)(poses)
        if self.symmetry is not None:
            poses[:, self.symmetry.column] = self.symmetry.folded(poses[:, self.symmetry.column])
        values = found.values(Poses(self.asked.names, (), poses), 0, len(poses))
        eigenvalues = found.eigenvalues(values)[: self.request.n_modes].T
        return float(np.abs(np.log(eigenvalues - found.frame.shift) - exact).max())

    def _in_words(self, found: Interpolation, worst: float) -> str:
        box, frame = found.box, found.frame
        level = "" if frame.level is None else f", below {np.sqrt(frame.level) / (2.0 * np.pi):.1f} Hz"
        nodes = f"{len(box.solved)} nodes ({' x '.join(map(str, box.shape))})"
        checked = f"largest error at {_HELD_OUT} poses solved exactly {worst / 2.0:.1e}"
        alike = "" if self.symmetry is None else f"; symmetric within {self.symmetry.defect / 2.0:.1e}"
        return f"{nodes}, {frame.size} modes followed together{level}{alike}; {checked}"


def _like_limbs(machine: Machine) -> set[int]:
    """How many instances the groups of like parts of a machine have."""
    return {len(instances) for instances in machine.description.file.symmetry.values()}


def _logarithms(solver: Solver, request: Request, pool: ThreadPoolExecutor) -> Logarithms:
    def logarithms(poses: FloatArray) -> FloatArray:
        exact = np.concatenate(list(solver.each(poses, lambda solved: solved.modes.eigenvalues, pool)))
        return np.asarray(np.log(exact[:, : request.n_modes] - solver.shift))

    return logarithms


def _kept(solved: Solved) -> Solved:
    return solved


def _frame_matrices(frame: Frame, solved: Solved) -> dict[str, FloatArray]:
    """Packed L and Z, and the frames W. Raises _NotSmoothError where the frame does not fit."""
    found = in_frame(frame, solved.systems, solved.modes)
    if found.alignment.min() < _LEAST_ALIGNMENT:
        raise _NotSmoothError("the low shapes change too much over the poses")
    rows, columns = np.tril_indices(frame.size)
    matrices = {"logarithm": found.logarithms[:, rows, columns], "frames": found.frames}
    if found.complements is not None:
        if np.any((np.linalg.eigvalsh(found.complements) < 0.0).sum(axis=1) != frame.size):
            raise _NotSmoothError("modes cross the level")
        matrices["complement"] = found.complements[:, rows, columns]
    return matrices


def _more(count: int, tail: float, largest: float) -> int:
    return int(np.ceil(count * _ENLARGED)) if tail > 0.2 * largest else count


def _modes_needed(home: System, request: Request) -> int:
    """Enough to find a gap above those asked for, and above those that resonate in the band."""
    if request.band is None:
        return request.n_modes + _EXTRA
    frequencies = home.modes(home.size).frequencies
    resonant = next((k for k, each in enumerate(frequencies) if reaches(request, each)), home.size)
    return max(request.n_modes, resonant) + _EXTRA
