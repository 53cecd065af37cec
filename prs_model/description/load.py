"""From machine.yaml and its URDF to a MachineDescription: read, validate, expand the symmetry, convert to SI."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from .. import plugins
from ..errors import DescriptionError, Problem
from .check_bodies import options_in_si
from .check_task import joint_dimension, joints_in_si, pose_in_si, verification_in_si, workspace_in_si
from .checks import check
from .expand import expanded, instances
from .messages import report, shown
from .problems import Place, Problems, dotted, line_of
from .schema import Body, Closure, Joint, MachineFile
from .subject import Subject
from .units import Units
from .urdf import Urdf, read_urdf
from .yaml_loader import read_yaml

FILE_NAME = "machine.yaml"
_GROUPS = ("bodies", "joints", "closures")


@dataclass(frozen=True)
class MachineDescription:
    """A machine as described, checked, in SI, with its symmetry expanded. Nothing in it is to be changed.

    `bodies`, `joints` and `closures` hold the instances by name (``rod_1``); `stems` gives the entry each of them
    comes from (``rod``). A body's `options` are validated and in SI, its travel stations in m or rad. `raw` is the
    file as written, in its own units, and `lines` the line of each entry.
    """

    path: Path
    folder: Path
    urdf_path: Path
    urdf: Urdf
    file: MachineFile
    bodies: Mapping[str, Body]
    joints: Mapping[str, Joint]
    closures: Mapping[str, Closure]
    stems: Mapping[str, str]
    reference_pose: Mapping[str, float]
    reference_joints: Mapping[str, float]
    workspace: Mapping[str, tuple[float, float]]
    verification_poses: Mapping[str, tuple[float, ...]]
    raw: Mapping[str, Any]
    lines: Mapping[Place, int | None]

    def problem(self, place: Place, message: str) -> DescriptionError:
        """The error for something wrong with one entry, such as ``("task", "reference")``, with its line."""
        return DescriptionError([Problem(self.path.name, line_of(place, self.lines), dotted(place), message)])


def load_description(path: str | Path) -> MachineDescription:
    """Read a machine.yaml, or the one in a folder, and the URDF it names.

    Raises DescriptionError listing everything that is wrong in the two files, with lines.
    """
    path = _machine_file(Path(path))
    document = read_yaml(path)
    return described(path, document.value, document.lines, {})


def described(
    path: Path, raw: Any, lines: Mapping[Place, int | None], origins: Mapping[str, str]
) -> MachineDescription:
    """The description of a file's content. `origins` names the stem of entries that were split from another."""
    problems = Problems(path.name, lines)
    file = _validated(raw, problems)
    urdf, urdf_problems = _urdf(path.parent, raw, problems)
    if file is not None:
        subject = Subject(path.parent, raw, file, urdf, expanded(file.bodies, file.symmetry), problems, origins)
        check(subject)
    problems.raise_if_any(urdf_problems)
    if file is None or urdf is None:
        raise DescriptionError([Problem(path.name, None, "", "cannot be used")])
    return _in_si(path, raw, lines, file, urdf, origins)


def _machine_file(path: Path) -> Path:
    if path.is_dir() and path.name != FILE_NAME:
        path = path / FILE_NAME
    if path.is_dir():
        raise DescriptionError([Problem(str(path), None, "", "is a folder, expected a file")])
    if not path.is_file():
        message = f"found no such file, expected a {FILE_NAME} or the folder of one"
        raise DescriptionError([Problem(str(path), None, "", message)])
    return path


def _validated(raw: Any, problems: Problems) -> MachineFile | None:
    """The file's sections. Entries with problems of their own are left out, so that the others can be checked."""
    if not isinstance(raw, Mapping):
        problems.add(
            (), f"found {shown(raw)}, expected the sections of a machine (name, urdf, task, bodies, joints ..)"
        )
        return None
    units = _units(raw.get("units"))
    context = {"units": units or Units()}
    try:
        return MachineFile.model_validate(raw, context=context)
    except ValidationError as error:
        report(error, MachineFile, raw, problems)
    if units is None or problems.touches(("symmetry",)):
        return None  # no number can be compared with another, or no instance be made
    try:
        return MachineFile.model_validate(_sound(raw, problems), context=context)
    except ValidationError:
        return None


def _units(raw: Any) -> Units | None:
    try:
        return Units.model_validate({} if raw is None else raw)
    except ValidationError:
        return None  # told with the rest of the file


def _sound(raw: Mapping[str, Any], problems: Problems) -> dict[str, Any]:
    kept: dict[str, Any] = {}
    for key, value in raw.items():
        if key in _GROUPS and isinstance(value, Mapping):
            kept[key] = {name: item for name, item in value.items() if not problems.touches((key, name))}
        elif key in MachineFile.model_fields and (
            MachineFile.model_fields[key].is_required() or not problems.touches((key,))
        ):
            kept[key] = value
    return kept


def _urdf(folder: Path, raw: Any, problems: Problems) -> tuple[Urdf | None, tuple[Problem, ...]]:
    name = raw.get("urdf") if isinstance(raw, Mapping) else None
    if not isinstance(name, str):
        return None, ()
    if not (folder / name).is_file():
        problems.add(("urdf",), f"found '{name}', expected a file in {folder}")
        return None, ()
    try:
        return read_urdf(folder / name), ()
    except DescriptionError as error:
        return None, error.problems


def _in_si(
    path: Path,
    raw: Mapping[str, Any],
    lines: Mapping[Place, int | None],
    file: MachineFile,
    urdf: Urdf,
    origins: Mapping[str, str],
) -> MachineDescription:
    coordinates = plugins.task(file.task.kind).coordinates
    entries = {
        name: body.model_copy(update={"options": options_in_si(body, file.units)}) for name, body in file.bodies.items()
    }
    bodies = expanded(entries, file.symmetry)
    return MachineDescription(
        path=path,
        folder=path.parent,
        urdf_path=urdf.path,
        urdf=urdf,
        file=file,
        bodies={name: _travel_in_si(body, urdf, file.units) for name, body in bodies.items()},
        joints=expanded(file.joints, file.symmetry),
        closures=expanded(file.closures, file.symmetry),
        stems=_stems(file, origins),
        reference_pose=pose_in_si(file, coordinates),
        reference_joints=joints_in_si(file, urdf),
        workspace=workspace_in_si(file, coordinates),
        verification_poses=verification_in_si(file, coordinates),
        raw=raw,
        lines=lines,
    )


def _travel_in_si(body: Body, urdf: Urdf, units: Units) -> Body:
    interfaces = {}
    for name, interface in body.interfaces.items():
        travel = interface.travel
        if travel is not None:
            factor = joint_dimension(urdf.joints[travel.joint]).factor(units)
            stations = tuple(station * factor for station in travel.stations)
            travel = travel.model_copy(update={"stations": stations})
            interface = interface.model_copy(update={"travel": travel})
        interfaces[name] = interface
    return body.model_copy(update={"interfaces": interfaces})


def _stems(file: MachineFile, origins: Mapping[str, str]) -> dict[str, str]:
    """The entry each instance comes from; a body's where a joint or closure has the same name."""
    return {
        instance.name: origins.get(instance.entry, instance.entry)
        for group in reversed(_GROUPS)
        for name, entry in getattr(file, group).items()
        for instance in instances(name, entry.per, file.symmetry)
    }
