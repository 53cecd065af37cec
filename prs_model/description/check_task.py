"""The task: its plug-in, coordinates, workspace and reference; and all of them in SI."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

from pydantic import ValidationError

from .. import plugins
from ..errors import PluginError, UnknownNameError
from .expand import substituted
from .messages import report
from .problems import Place, listed, not_known
from .schema import MachineFile
from .subject import Subject
from .units import Dimension, Units
from .urdf import Urdf, UrdfJoint

LENGTH, ANGLE = Dimension(length=1), Dimension(angle=1)


def check_task(subject: Subject) -> None:
    """Check the task, the reference configuration and the workspace."""
    task = subject.file.task
    subject.check_link(("task", "frame"), task.frame)
    if task.relative_to is not None:
        subject.check_link(("task", "relative_to"), task.relative_to)
    plugin = _plugin(subject)
    if plugin is not None:
        _check_options(subject, plugin)
        for key, values in (("workspace", task.workspace), ("reference", task.reference.pose)):
            place = ("task", key) if key == "workspace" else ("task", key, "pose")
            _check_names(subject, place, "a pose coordinate", values, plugin.coordinates)
        _check_workspace(subject, plugin.coordinates)
        _check_verification(subject, plugin.coordinates)
    if subject.urdf is not None:
        _check_joint_values(subject, subject.urdf)


def joint_dimension(joint: UrdfJoint) -> Dimension:
    """What a joint's value is: an angle, or a length."""
    return ANGLE if joint.is_rotary else LENGTH


def workspace_in_si(file: MachineFile, coordinates: Mapping[str, Dimension]) -> dict[str, tuple[float, float]]:
    """The bounds of each pose coordinate, in the order of the task's coordinates."""
    factors = {name: dimension.factor(file.units) for name, dimension in coordinates.items()}
    bounds = file.task.workspace
    return {name: (bounds[name][0] * k, bounds[name][1] * k) for name, k in factors.items()}


def pose_in_si(file: MachineFile, coordinates: Mapping[str, Dimension]) -> dict[str, float]:
    """The reference pose, in the order of the task's coordinates."""
    pose = file.task.reference.pose
    return {name: pose[name] * dimension.factor(file.units) for name, dimension in coordinates.items()}


def verification_in_si(file: MachineFile, coordinates: Mapping[str, Dimension]) -> dict[str, tuple[float, ...]]:
    """The values of pose coordinates that the verification section combines; none without that section."""
    poses = file.verification.poses if file.verification is not None else {}
    factors = {name: dimension.factor(file.units) for name, dimension in coordinates.items()}
    return {name: tuple(float(value) * factors[name] for value in values) for name, values in poses.items()}


def joints_in_si(file: MachineFile, urdf: Urdf) -> dict[str, float]:
    """The reference value of every movable joint [m, rad], in the order of the URDF."""
    values = _joint_values(file)
    return {name: values[name][1] * joint_dimension(joint).factor(file.units) for name, joint in urdf.movable.items()}


def _plugin(subject: Subject) -> Any:
    kind = subject.file.task.kind
    try:
        return plugins.task(kind)
    except UnknownNameError as error:
        subject.problems.add(("task", "kind"), not_known("a task", kind, error.known))
    except PluginError as error:
        subject.problems.add(("task", "kind"), str(error))
    return None


def _check_options(subject: Subject, plugin: Any) -> None:
    options = subject.file.task.options
    known = getattr(plugin, "Options", None)
    if known is None:
        for name in options:
            subject.problems.add(("task", "options", name), "found an option, expected none; this task has no options")
        return
    try:
        known.model_validate(options, context={"units": subject.file.units})
    except ValidationError as error:
        report(error, known, options, subject.problems, ("task", "options"))


def _check_names(
    subject: Subject, place: Place, what: str, given: Mapping[str, Any], expected: Mapping[str, Any]
) -> None:
    for name in given:
        if name not in expected:
            subject.problems.add((*place, name), not_known(what, name, expected))
    missing = [name for name in expected if name not in given]
    if missing and all(name in expected for name in given):
        subject.problems.add(place, f"found no value for {listed(missing)}, expected one each")


def _check_workspace(subject: Subject, coordinates: Mapping[str, Dimension]) -> None:
    task = subject.file.task
    for name, (low, high) in task.workspace.items():
        place = ("task", "workspace", name)
        if low > high:
            subject.problems.add(place, f"found [{low:g}, {high:g}], expected [low, high]")
        elif name in coordinates and name in task.reference.pose:
            unit = coordinates[name].label(subject.file.units)
            value = task.reference.pose[name]
            _check_range(subject, ("task", "reference", "pose", name), value, (low, high), unit, "the workspace")


def _check_verification(subject: Subject, coordinates: Mapping[str, Dimension]) -> None:
    poses = subject.file.verification.poses if subject.file.verification is not None else {}
    for name, values in poses.items():
        place = ("verification", "poses", name)
        if name not in coordinates:
            subject.problems.add(place, not_known("a pose coordinate", name, coordinates))
        elif not values:
            subject.problems.add(place, "found an empty list, expected the values that the coordinate shall take")


def _check_range(
    subject: Subject, place: Place, value: float, bounds: tuple[float, float], unit: str, whose: str
) -> None:
    low, high = bounds
    slack = 1e-9 * max(1.0, *(abs(bound) for bound in bounds if math.isfinite(bound)), abs(value))
    if not low - slack <= value <= high + slack:
        message = f"found {value:g} {unit}, expected {low:g} .. {high:g} {unit}, the limits of {whose}"
        subject.problems.add(place, message)


def _joint_values(file: MachineFile) -> dict[str, tuple[str, float]]:
    """Joint name -> (key as written, value in the file's units); a key may hold a placeholder."""
    values = {}
    for key, value in file.task.reference.joints.items():
        groups = [group for group in file.symmetry if f"<{group}>" in key]
        members = file.symmetry[groups[0]] if groups else ("",)
        for member in members:
            name = substituted(key, {f"<{groups[0]}>": str(member)}) if groups else key
            values[name] = (key, float(value))
    return values


def _check_joint_values(subject: Subject, urdf: Urdf) -> None:
    place: Place = ("task", "reference", "joints")
    values = _joint_values(subject.file)
    for name, (key, value) in values.items():
        if name not in urdf.movable:
            what = "a joint of the URDF that moves"
            subject.problems.add((*place, key), not_known(what, name, urdf.movable))
        else:
            _check_joint_value(subject, (*place, key), urdf.joints[name], value)
    missing = [name for name in urdf.movable if name not in values]
    if missing and all(name in urdf.movable for name in values):
        subject.problems.add(place, f"found no value for {listed(missing)}, expected one for every joint that moves")


def _check_joint_value(subject: Subject, place: Place, joint: UrdfJoint, value: float) -> None:
    units: Units = subject.file.units
    dimension = joint_dimension(joint)
    factor = dimension.factor(units)
    bounds = (joint.lower / factor, joint.upper / factor)
    whose = f"joint '{joint.name}' in {subject.urdf.path.name}:{joint.line}" if subject.urdf else "the joint"
    _check_range(subject, place, value, bounds, dimension.label(units), whose)
