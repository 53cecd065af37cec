"""From a machine and its poses to a folder with the report in it."""

from __future__ import annotations

import json
import logging
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import PrsError
from ..modes.figure_file import check_writable
from .card import joints_of, moving_mass, parts_of
from .figures import draw_figures
from .glb import glb
from .numbers import as_dict, write_bytes, write_card, write_tables, write_text
from .page import Content, Pose, environment, page
from .scene import scene_of
from .sources import entries
from .still import draw_still
from .study import Study, study
from .workspace import workspace_map

if TYPE_CHECKING:
    from ..machine import Machine
    from ..response import DampingLike

PAGE = "report.html"
_HEAVY = 10e6  # bytes
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
    The folder is made if need be; files of the same names are replaced, each whole or not at all, others are left
    alone. Returns the files, the page first.
    Raises PrsError for a folder that cannot be written to, UnreachablePoseError, or MissingExtraError (extra `report`).
    """
    folder = Path(folder)
    if not poses:
        raise PrsError("report: found no pose, expected at least one")
    check_folder(folder)
    with _warnings_logged() as warnings:
        studies = [study(machine, pose, number, count, damping) for number, pose in enumerate(poses, start=1)]
        parts, said = parts_of(machine)
    outside = [f"pose {each.text} is {said}" for each in studies for said in machine.outside_workspace(each.pose)]
    standing = (*machine.loose_bodies(), *machine.wide_joints(), *said)
    made = tuple(_pose(each, studies[0], folder) for each in studies)
    drawn = workspace_map(machine, folder, len(studies[0].modes.frequencies)) if with_map else (None, ())
    content = Content(
        machine=machine,
        poses=made,
        parts=parts,
        joints=joints_of(machine),
        entries=entries(machine.description),
        mass=moving_mass(machine),
        warnings=tuple(dict.fromkeys([*warnings, *standing, *outside])),
        published=_published(machine, studies[0]),
        command=command,
        map=drawn[0],
        map_files=drawn[1],
    )
    beside = _beside(content, folder)
    text = page(content, folder)
    if len(text) > _HEAVY:
        _log.warning("%s is %.0f MB; fewer poses make it lighter", folder / PAGE, len(text) / 1e6)
    write_text(folder / PAGE, text)
    return (folder / PAGE, *(folder / name for name in beside))


def check_folder(folder: Path) -> None:
    """Make the folder. Raises PrsError when it cannot be made or written to, or MissingExtraError, before any work."""
    from ..response.picture import matplotlib_figure

    matplotlib_figure()
    environment()
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise PrsError(f"{folder}: cannot be made ({error.strerror}); expected a folder to write to") from error
    check_writable(folder / PAGE)


def _pose(study: Study, first: Study, folder: Path) -> Pose:
    """Everything of one pose but the page."""
    _log.info("pose %d: %s", study.number, study.text)
    own = folder / study.folder
    own.mkdir(exist_ok=True)
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
    results = {"machine": content.machine.name, "poses": [as_dict(each.study) for each in content.poses]}
    write_text(folder / "results.json", json.dumps(results, indent=1, allow_nan=False) + "\n")
    names = ["results.json", *content.map_files, *write_card(content.parts, content.joints, content.entries, folder)]
    return names + [f"{each.study.folder}/{name}" for each in content.poses for name in each.files]


def _published(machine: Machine, first: Study) -> dict[str, tuple[float, ...]]:
    """Frequencies [Hz] that others found at the reference pose, when that is the first one."""
    verification = machine.description.file.verification
    at_reference = all(abs(first.pose[name] - value) < 1e-9 for name, value in machine.reference_pose.items())
    return {} if verification is None or not at_reference else dict(verification.published)


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
