"""Super-elements written for other programs, by the reducer that reads such files."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from .. import plugins
from ..description.units import Units
from ..errors import PartFileError, PrsError
from .super_element import SuperElement


def export(element: SuperElement, path: str | Path, *, units: str = "m-N-kg-s") -> None:
    """Write an element in the format of the path's suffix, such as .op4, .pch, .mtx or .npz (always SI).

    units: of the file, such as ``mm-N-tonne-s``. Companion files get names from the same stem. Raises PartFileError
    when no installed reducer writes such files, or when the element or the folder does not allow it.
    """
    path = Path(path)
    writer = _writer(path)
    try:
        known = Units.parse(units)
    except ValueError as error:
        raise PrsError(f"units of {path.name}: {error}") from error
    writer.write(element, path, known)


def check_writable(path: Path) -> None:
    """Raises PartFileError when no installed reducer writes files of this suffix, or there is no such folder."""
    _writer(path)
    if not path.parent.is_dir():
        raise PartFileError(path, f"there is no folder {path.parent}")


def _writer(path: Path) -> plugins.Reducer[Any]:
    writers = {suffix: name for name in plugins.list_reducers() for suffix in plugins.reducer(name).writes}
    if path.suffix.lower() not in writers:
        known = ", ".join(f"{suffix} ({name})" for suffix, name in sorted(writers.items()))
        raise PartFileError(path, f"found the suffix '{path.suffix}', expected one that a reducer writes: {known}")
    return plugins.reducer(writers[path.suffix.lower()])
