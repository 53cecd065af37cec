"""Super-elements written for other programs, by the reducer that reads such files."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from .. import plugins
from ..description.units import Units
from ..errors import PartFileError, PrsError
from .super_element import SuperElement

SI = "m-N-kg-s"

logger = logging.getLogger("prs_model")


def export(element: SuperElement, path: str | Path, *, units: str = SI, keep: Iterable[Path] = ()) -> None:
    """Write an element in the format of the path's suffix, such as .op4, .pch, .mtx or .npz (always SI).

    units: of the file, such as ``mm-N-tonne-s``. Companion files get names from the same stem; keep: files that none of
    them may overwrite. Raises PartFileError when no installed reducer writes such files, or when the element or the
    folder does not allow it, and PrsError for an argument that is none of these.
    """
    if not isinstance(element, SuperElement):
        raise PrsError(f"export: found {type(element).__name__}, expected a SuperElement, such as reduce gives")
    path, keep = Path(path), tuple(keep)
    check_writable(path, units=units, keep=keep)
    writer, known = _writer(path), Units.parse(units)
    if keep:
        _check_kept(_written(writer, element, path, known), keep)
    writer.write(element, path, known)


def check_writable(path: Path, *, units: str = SI, keep: Iterable[Path] = ()) -> None:
    """Whether a file can be written there in these units, as far as that is known without its content.

    Raises PartFileError when no installed reducer writes files of this suffix, or not in these units, when there is no
    such folder, or the file is one of those to `keep`; PrsError for units that are none.
    """
    writer = _writer(path)
    try:
        known = Units.parse(units)
    except ValueError as error:
        raise PrsError(f"units of {path.name}: {error}") from error
    if writer.units == "SI" and known != Units.parse(SI):
        raise PartFileError(path, f"found units {units}, expected none: files of suffix {path.suffix} are always in SI")
    if not path.parent.is_dir():
        raise PartFileError(path, f"there is no folder {path.parent}")
    _check_kept([path], keep)


def _written(writer: plugins.Reducer[Any], element: SuperElement, path: Path, units: Units) -> list[Path]:
    """The files that a writer makes, companions too; found by writing them elsewhere."""
    with TemporaryDirectory() as folder:
        writer.write(element, Path(folder) / path.name, units)
        return [path.parent / file.name for file in Path(folder).iterdir()]


def _check_kept(written: Iterable[Path], keep: Iterable[Path]) -> None:
    kept = {file.resolve() for file in keep}
    for file in written:
        if file.resolve() in kept:
            raise PartFileError(
                file, "the part is read from this file, which would be overwritten; choose another name"
            )


def _writer(path: Path) -> plugins.Reducer[Any]:
    writers: dict[str, str] = {}
    for name in plugins.list_reducers():
        for suffix in plugins.reducer(name).writes:
            first = writers.setdefault(suffix, name)
            if first != name and suffix == path.suffix.lower():
                logger.warning("reducers '%s' and '%s' both write %s files: '%s' does", first, name, suffix, first)
    if path.suffix.lower() not in writers:
        known = ", ".join(f"{suffix} ({name})" for suffix, name in sorted(writers.items()))
        raise PartFileError(path, f"found the suffix '{path.suffix}', expected one that a reducer writes: {known}")
    return plugins.reducer(writers[path.suffix.lower()])
