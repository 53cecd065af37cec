"""From poses to configurations of a closed machine."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray
from ..description import MachineDescription
from ..errors import PrsError, UnreachablePoseError
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
        self.model = pin.buildModelFromUrdf(str(description.urdf_path))
        self.tree = read_tree(self.model)
        options = plugin.Options.model_validate(section.options, context={"units": units})
        self.task = plugin(self.tree, section, options)
        self.pose_names = tuple(self.task.coordinates)
        measured_in = section.relative_to or description.urdf.root
        self.equations = set_up(self.tree, description.closures, self.task, section.frame, measured_in)
        self.reach = Reach(self.tree, self.task.coordinates, description.file.symmetry)
        reference = reference_configuration(description, self.equations, self.reach)
        target = self.task.targets(self._as_array(description.reference_pose))[0]
        self.branch = Branch(self.equations, reference, target)
        if self.has_closed_form:
            self._check_branch_of_closed_form()

    def solve(self, pose: Mapping[str, float]) -> Configuration:
        """The configuration at a pose [m, rad].

        Raises UnreachablePoseError naming limb, joint, value and limits, and PrsError for a pose with missing, unknown
        or non-finite coordinates.
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
        q = self.task.closed_form(poses)
        if q is None:
            raise PrsError(f"task '{self.description.file.task.kind}' gives no closed form at these poses")
        missed = np.flatnonzero(np.isnan(q).any(axis=1))
        errors = {int(i): self.reach.no_closed_form(poses[i], q[i]) for i in missed}
        q[missed] = np.nan
        residual = self._residual(poses, q)
        self._check_closed_form(residual)
        return self._result(poses, q, residual, errors)

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

    def _check_closed_form(self, residual: FloatArray) -> None:
        """A closed form whose loops stay open was made for another geometry than the URDF's."""
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
        """One pose as (1, d). Raises PrsError for coordinates that are missing, unknown or not finite."""
        for name in pose:
            if name not in self.pose_names:
                raise unknown("pose coordinate", name, list(self.pose_names))
        missing = [name for name in self.pose_names if name not in pose]
        if missing:
            raise PrsError(f"pose: found no value for {', '.join(missing)}, expected {', '.join(self.pose_names)}")
        return self._checked(np.array([[pose[name] for name in self.pose_names]], dtype=float))

    def _checked(self, poses: FloatArray) -> FloatArray:
        """Poses as a copy (N, d). Raises PrsError for a wrong shape or a number that is not finite."""
        poses = np.array(poses, dtype=float)
        expected = f"expected (N, {len(self.pose_names)}): {', '.join(self.pose_names)}"
        if poses.ndim != 2 or poses.shape[1] != len(self.pose_names):
            raise PrsError(f"poses: found an array of shape {poses.shape}, {expected}")
        wrong = np.argwhere(~np.isfinite(poses))
        if wrong.size:
            i, k = wrong[0]
            raise PrsError(f"pose {i}: found {poses[i, k]} for {self.pose_names[k]}, expected a finite number [m, rad]")
        return poses


def _chunks(count: int) -> Iterator[slice]:
    return (slice(start, start + _CHUNK) for start in range(0, count, _CHUNK))
