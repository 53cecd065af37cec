"""From a machine and its poses to a folder with the report in it."""

from __future__ import annotations

import json
import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import PrsError, short
from .card import joints_of, moving_mass, parts_of
from .figures import draw_figures
from .folder import PAGE, RESULTS, built, folder_for
from .glb import glb
from .numbers import as_dict, units_of, write_bytes, write_card, write_tables, write_text
from .page import Content, Pose, environment, page
from .scene import scene_of
from .sources import entries
from .still import draw_still
from .study import Study, study
from .workspace import workspace_map

if TYPE_CHECKING:
    from ..machine import Machine
    from ..response import DampingLike
    from .card import Part

_LARGEST = 10_000_000  # bytes of the page, which is sent by mail
_log = logging.getLogger(__name__)


def write_report(
    machine: Machine,
    folder: str | Path,
    poses: Sequence[Mapping[str, float]] = ({},),
    count: int = 8,
    damping: DampingLike = None,
    command: str = "",
    with_map: bool = False,
) -> tuple[Path, ...]:
    """Write report.html, and beside it figures, tables and animations of each pose [m, rad] in a folder of its own.

    poses: coordinates left out take their reference values. count: modes shown. damping: as in Modes.frf, default the
    machine's own. command: what made the report, for the page. with_map: sweep the workspace too.
    The folder is made if need be. The files of the last report there are replaced by the new ones, all of them or none;
    others are left alone. Returns the files, the page first.
    Raises PrsError for a folder that cannot be written to or a page above 10 MB, UnreachablePoseError, or
    MissingExtraError (extra `report`).
    """
    _check_poses(poses)
    folder = check_folder(folder, len(poses))
    with _warnings_logged() as warnings:
        studies = [study(machine, pose, number, count, damping) for number, pose in enumerate(poses, start=1)]
        parts, said = parts_of(machine)
    outside = [f"pose {each.text} is {said}" for each in studies for said in machine.outside_workspace(each.pose)]
    standing = (*machine.loose_bodies(), *machine.wide_joints(), *said)
    told = tuple(dict.fromkeys([*warnings, *standing, *outside]))
    with built(folder) as made:
        names = _write(machine, studies, parts, told, made, command, with_map)
    return tuple(folder / name for name in names)


def check_folder(folder: str | Path, poses: int = 1) -> Path:
    """Make the folder. Raises PrsError when it cannot be made or written to, or MissingExtraError, before any work."""
    from .figures import report_figure

    report_figure()
    environment()
    return folder_for(folder, poses)


def _check_poses(poses: object) -> None:
    if isinstance(poses, str) or not isinstance(poses, Sequence) or not all(isinstance(p, Mapping) for p in poses):
        raise PrsError(f"poses: found {short(repr(poses))}, expected a list of them, such as [{{}}, {{'z': 0.09}}]")
    if not poses:
        raise PrsError("report: found no pose, expected at least one")


def _write(
    machine: Machine,
    studies: Sequence[Study],
    parts: tuple[Part, ...],
    warnings: tuple[str, ...],
    folder: Path,
    command: str,
    with_map: bool,
) -> tuple[str, ...]:
    """Write everything into an empty folder; the names of the files, the page first."""
    made = tuple(_pose(each, studies[0], folder) for each in studies)
    drawn = workspace_map(machine, folder, len(studies[0].modes.frequencies)) if with_map else (None, ())
    content = Content(
        machine=machine,
        poses=made,
        parts=parts,
        joints=joints_of(machine),
        entries=entries(machine.description),
        mass=moving_mass(machine),
        warnings=warnings,
        command=command,
        map=drawn[0],
        map_files=drawn[1],
    )
    beside = _beside(content, folder)
    text = page(content, folder)
    if (size := len(text.encode())) > _LARGEST:
        what = f"{size / 1e6:.1f} MB (poses: {len(studies)}, modes: {len(studies[0].modes.frequencies)})"
        raise PrsError(f"report: the page would take {what}, expected 10 MB at most; give fewer of either")
    write_text(folder / PAGE, text)
    return (PAGE, *beside)


def _pose(study: Study, first: Study, folder: Path) -> Pose:
    """Everything of one pose but the page."""
    _log.info("pose %d: %s", study.number, study.text)
    own = folder / study.folder
    own.mkdir()
    scene = scene_of(study.modes)
    draw_still(study, scene, own / "mode_shapes.png")
    figures = draw_figures(study, first, own)
    names = [f"mode_{k + 1}.glb" for k in range(len(study.modes.frequencies))]
    for k, name in enumerate(names):
        write_bytes(own / name, glb(scene, k, f"mode {k + 1}, {study.modes.frequencies[k]:.1f} Hz"))
    drawn = [f"{each.name}.{suffix}" for each in figures for suffix in ("svg", "png")]
    return Pose(study, scene, figures, ("mode_shapes.png", *drawn, *names, *write_tables(study, first, own)))


def _beside(content: Content, folder: Path) -> list[str]:
    """Writes what belongs to no pose; the names of all files but the page."""
    names = [*content.map_files, *write_card(content.parts, content.joints, content.entries, folder)]
    names += [f"{each.study.folder}/{name}" for each in content.poses for name in each.files]
    kinds = content.machine.kinematics.task.coordinates
    results = {
        "machine": content.machine.name,
        "units": units_of(kinds),
        "poses": [as_dict(each.study) for each in content.poses],
        "files": [PAGE, RESULTS, *names],
    }
    write_text(folder / RESULTS, json.dumps(results, indent=1, allow_nan=False) + "\n")
    return [RESULTS, *names]


@contextmanager
def _warnings_logged() -> Iterator[list[str]]:
    """What the library warns of meanwhile."""
    found: list[str] = []
    handler = _Kept(found)
    logger = logging.getLogger("prs_model")
    logger.addHandler(handler)
    try:
        yield found
    finally:
        logger.removeHandler(handler)


class _Kept(logging.Handler):
    """Keeps the text of warnings."""

    def __init__(self, found: list[str]):
        super().__init__(logging.WARNING)
        self.found = found

    def emit(self, record: logging.LogRecord) -> None:
        self.found.append(record.getMessage())
