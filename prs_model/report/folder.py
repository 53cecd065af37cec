"""The folder of a report: what is made takes the place of the last report's files, all at once."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from ..errors import PrsError, short
from ..modes.figure_file import check_writable

PAGE = "report.html"
RESULTS = "results.json"
_OURS = re.compile(r"(pose_\d+/)?\w+\.(csv|glb|html|json|png|svg)")


def folder_for(folder: str | Path, poses: int = 1) -> Path:
    """The folder, made if need be. Raises PrsError when a report of so many poses cannot be written to it."""
    if not isinstance(folder, str | os.PathLike) or not str(folder).strip():
        raise PrsError(f"report: found {short(repr(folder))} as a folder, expected the name of one, such as out/report")
    folder = Path(folder)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise PrsError(f"{folder}: cannot be made ({error.strerror}); expected a folder to write to") from error
    _check_places(folder, [PAGE, RESULTS, *(f"pose_{number}/modes.csv" for number in range(1, poses + 1))])
    check_writable(folder / PAGE)
    return folder


@contextmanager
def built(folder: Path) -> Iterator[Path]:
    """A folder to make a report in. When that has gone well, its files replace those of the last report in `folder`.

    Until then the last report stands; its own files that the new one does not have are removed, others are left alone.
    Raises PrsError.
    """
    try:
        made = TemporaryDirectory(dir=folder, prefix=".report-")
    except OSError as error:
        raise PrsError(f"{folder}: cannot be written to ({error.strerror or error})") from error
    with made as name:
        yield Path(name)
        _replace(folder, Path(name))


def _replace(folder: Path, made: Path) -> None:
    """The page is the first to go and the last to come."""
    names = sorted(path.relative_to(made).as_posix() for path in made.rglob("*") if path.is_file())
    _check_places(folder, names)
    old = [name for name in _listed(folder) if name not in names]
    try:
        for name in (PAGE, *old):
            (folder / name).unlink(missing_ok=True)
        for parent in {Path(name).parent for name in old} - {Path()}:
            _remove_empty(folder / parent)
        for name in sorted(names, key=lambda each: (each == PAGE, each != RESULTS)):
            (folder / name).parent.mkdir(exist_ok=True)
            (made / name).replace(folder / name)
    except OSError as error:
        raise PrsError(f"{folder}: a report cannot be put there ({error.strerror or error})") from error


def _check_places(folder: Path, names: Iterable[str]) -> None:
    """Raises PrsError where a file is in a folder's place, or the other way round."""
    for name in names:
        path = folder / name
        if path.parent.exists() and not path.parent.is_dir():
            raise PrsError(f"{path.parent}: found a file, where the report has a folder; move it, or choose another -o")
        if path.is_dir():
            raise PrsError(f"{path}: found a folder, where the report has a file; move it, or choose another -o")


def _listed(folder: Path) -> tuple[str, ...]:
    """The files of the last report, as far as its results tell."""
    try:
        results = json.loads((folder / RESULTS).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return ()
    files = results.get("files", ()) if isinstance(results, dict) else ()
    return tuple(name for name in files if isinstance(name, str) and _OURS.fullmatch(name))


def _remove_empty(folder: Path) -> None:
    if folder.is_dir() and not any(folder.iterdir()):
        folder.rmdir()
