"""From poses to configurations of a closed machine."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import product
from numbers import Real

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray
from ..description import MachineDescription
from ..errors import DescriptionError, Problem, PrsError, UnreachablePoseError
from ..plugins import task as task_plugin
from ..plugins import unknown
from .branch import Branch
from .configuration import Configuration, Configurations
from .equations import set_up
from .newton import newton
from .pinocchio_newton import pinocchio_newton
from .reach import Reach
from .reference import reference_configuration
from .tasks import Task
from .tree import pinocchio_values, read_tree

_CHUNK = 1000  # poses solved at once, to bound memory
_CLOSED_FORM_TOLERANCE = 1e-9  # of its residual [m, rad]
_CHECKED_SHARES = (0.0, 0.3, 1.0)  # of each range of the workspace: poses at which a closed form is checked
_LARGEST_VALUE = 1e6  # of a pose coordinate [m, rad]; beyond it no digit of an angle is left


class Kinematics:
    """Closed-loop kinematics of a machine, built once and used at many poses.

    Poses are reached from the stored reference configuration, on its assembly branch: by the task's closed form if it
    brings one, else by Newton's method. Pose coordinates and joint values are in m and rad.
    """

    model: pin.Model
    task: Task
    pose_names: tuple[str, ...]

    def __init__(self, description: MachineDescription):
        """Raises DescriptionError when the reference configuration, the closures and the task do not fit together."""
        section, units = description.file.task, description.file.units
        plugin: type[Task] = task_plugin(section.kind)
        self.description = description
        self.model = _pinocchio_model(description)
        self.tree = read_tree(self.model)
        options = plugin.Options.model_validate(section.options, context={"units": units})
        self.task = plugin(self.tree, section, options)
        self.pose_names = tuple(self.task.coordinates)
        measured_in = section.relative_to or description.urdf.root
        self.equations = set_up(self.tree, description.closures, self.task, section.frame, measured_in)
        self.reach = Reach(self.tree, self.task.coordinates, description.file.symmetry)
        pose = self._as_array(description.reference_pose)
        reference = reference_configuration(description, self.equations, self.reach)
        self.branch = Branch(self.equations, reference, self.task.targets(pose)[0])
        if self.has_closed_form:
            self._check_closed_form()
            self._check_branch_of_closed_form()

    def solve(self, pose: Mapping[str, float]) -> Configuration:
        """The configuration at a pose [m, rad].

        Raises UnreachablePoseError naming limb, joint, value and limits, and PrsError for a pose with missing or
        unknown coordinates, or values that are no numbers within a million.
        """
        return self._closed_form(self._as_array(pose))[0] if self.has_closed_form else self.newton(pose)

    def solve_batch(self, poses: FloatArray) -> Configurations:
        """Configurations at poses (N, d) [m, rad], columns as in `pose_names`; unreachable ones are marked."""
        poses = self._checked(poses)
        return self._closed_form(poses) if self.has_closed_form else self.newton_batch(poses)

    def newton(self, pose: Mapping[str, float]) -> Configuration:
        """As `solve`, by Newton's method on Pinocchio's frames and constraints whatever the task brings."""
        poses = self._as_array(pose)
        targets = self.task.targets(poses)
        q, solved = pinocchio_newton(self.model, self.equations, self.branch.q, targets[0])
        return self._followed(poses, *self.branch.settle(q[None], np.array([solved]), targets))[0]

    def newton_batch(self, poses: FloatArray) -> Configurations:
        """As `solve_batch`, by Newton's method whatever the task brings."""
        poses = self._checked(poses)
        q, share = np.empty((len(poses), self.tree.size)), np.ones(len(poses))
        for some in _chunks(len(poses)):
            targets = self.task.targets(poses[some])
            start = np.tile(self.branch.q, (len(targets), 1))
            q[some], share[some] = self.branch.settle(*newton(self.equations, start, targets), targets)
        return self._followed(poses, q, share)

    @property
    def has_closed_form(self) -> bool:
        """Whether the task brings a closed form."""
        return type(self.task).closed_form is not Task.closed_form

    def pinocchio_values(self, configuration: Configuration) -> FloatArray:
        """Joint values as `model` wants them: a continuous joint takes a cosine and a sine."""
        return pinocchio_values(self.model, configuration.q)

    def _followed(self, poses: FloatArray, q: FloatArray, share: FloatArray) -> Configurations:
        """Results of Newton's method; `share` is the part of the way from the reference that was possible."""
        missed = np.flatnonzero(share < 1.0)
        errors = {int(i): self.reach.cut_off(poses[i], q[i], share[i]) for i in missed}
        q[missed] = np.nan
        return self._result(poses, q, self._residual(poses, q), errors)

    def _closed_form(self, poses: FloatArray) -> Configurations:
        q = self._closed_form_values(poses)
        missed = np.flatnonzero(np.isnan(q).any(axis=1))
        errors = {int(i): self.reach.no_closed_form(poses[i], q[i]) for i in missed}
        gaps = self._residual(poses, q).max(axis=1, initial=0.0)
        wide = np.flatnonzero(np.isfinite(gaps) & (gaps > _CLOSED_FORM_TOLERANCE))
        errors |= {int(i): self.reach.left_open(poses[i], gaps[i]) for i in wide}
        q[list(errors)] = np.nan
        return self._result(poses, q, self._residual(poses, q), errors)

    def _closed_form_values(self, poses: FloatArray) -> FloatArray:
        q = self.task.closed_form(poses)
        if q is None:
            raise PrsError(f"task '{self.description.file.task.kind}' gives no closed form at these poses")
        return q

    def _residual(self, poses: FloatArray, q: FloatArray) -> FloatArray:
        """Closure rows, then task rows (N, m), in absolute value; infinite where there is no configuration."""
        rows = np.empty((len(q), self.equations.loop_rows + len(self.pose_names)))
        for some in _chunks(len(q)):
            frames = self.tree.forward(q[some])
            rows[some] = self.equations.residual(frames, self.task.targets(poses[some]))
        return np.nan_to_num(np.abs(rows), nan=np.inf)

    def _result(
        self, poses: FloatArray, q: FloatArray, residual: FloatArray, errors: Mapping[int, UnreachablePoseError]
    ) -> Configurations:
        """Configurations, with those that pass a joint limit added to the errors."""
        beyond = np.flatnonzero(self.reach.excess(q).any(axis=1))
        limits = {int(i): self.reach.beyond_limits(poses[i], q[i]) for i in beyond}
        errors = {**errors, **{i: error for i, error in limits.items() if error is not None}}
        gaps = np.max(residual[:, : self.equations.loop_rows], axis=1, initial=0.0)
        return Configurations(self.pose_names, poses, q, gaps, errors, self.tree)

    def _check_closed_form(self) -> None:
        """A closed form that leaves the loops open in the workspace was made for another geometry than the URDF's."""
        bounds = self.description.workspace.values()
        grid = product(*([low + share * (high - low) for share in _CHECKED_SHARES] for low, high in bounds))
        poses = np.array([list(self.description.reference_pose.values()), *grid])
        residual = self._residual(poses, self._closed_form_values(poses))
        gap = float(np.max(residual, where=np.isfinite(residual), initial=0.0))
        if gap > _CLOSED_FORM_TOLERANCE:
            message = (
                f"found a closed form that leaves the loops or the pose open by {gap:.3g} m or rad, expected "
                f"{_CLOSED_FORM_TOLERANCE:g}; the URDF is not of the geometry this task is made for: correct it, "
                "or use a task without closed form"
            )
            raise self.description.problem(("task", "kind"), message)

    def _check_branch_of_closed_form(self) -> None:
        result = self._closed_form(self._as_array(self.description.reference_pose))
        if not np.allclose(result.q[0], self.branch.q, atol=1e-6):
            message = (
                "found joint values of another assembly branch than that of the task's closed form; correct the joint "
                "values, or use a task without closed form"
            )
            raise self.description.problem(("task", "reference", "joints"), message)

    def _as_array(self, pose: Mapping[str, float]) -> FloatArray:
        """One pose as (1, d). Raises PrsError for coordinates that are missing, unknown or no numbers."""
        for name, value in pose.items():
            if name not in self.pose_names:
                raise unknown("pose coordinate", name, list(self.pose_names))
            if not isinstance(value, Real) or isinstance(value, bool):
                raise PrsError(f"pose: found {value!r:.60} for {name}, expected one number [m, rad]")
        missing = [name for name in self.pose_names if name not in pose]
        if missing:
            raise PrsError(f"pose: found no value for {', '.join(missing)}, expected {', '.join(self.pose_names)}")
        return self._checked(np.array([[pose[name] for name in self.pose_names]], dtype=float))

    def _checked(self, poses: FloatArray) -> FloatArray:
        """Poses as a copy (N, d). Raises PrsError for a wrong shape or a value that is no number within a million."""
        expected = f"expected (N, {len(self.pose_names)}): {', '.join(self.pose_names)}"
        try:
            poses = np.array(poses, dtype=float)
        except (TypeError, ValueError) as error:
            raise PrsError(f"poses: found no array of numbers ({error}), {expected}") from error
        if poses.ndim != 2 or poses.shape[1] != len(self.pose_names):
            raise PrsError(f"poses: found an array of shape {poses.shape}, {expected}")
        wrong = np.argwhere(~(np.abs(poses) <= _LARGEST_VALUE))
        if wrong.size:
            i, k = wrong[0]
            where, limit = f"pose {i}" if len(poses) > 1 else "pose", f"{_LARGEST_VALUE:,.0f}"
            message = f"{where}: found {poses[i, k]:g} for {self.pose_names[k]}, expected a number"
            raise PrsError(f"{message} between -{limit} and {limit} [m, rad]")
        return poses


def _pinocchio_model(description: MachineDescription) -> pin.Model:
    try:
        return pin.buildModelFromUrdf(str(description.urdf_path))
    except (ValueError, RuntimeError) as error:
        message = f"Pinocchio cannot read it ({error}); correct the URDF"
        raise DescriptionError([Problem(description.urdf_path.name, None, "", message)]) from error


def _chunks(count: int) -> Iterator[slice]:
    return (slice(start, start + _CHUNK) for start in range(0, count, _CHUNK))
