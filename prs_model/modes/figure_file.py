"""Pictures as files: complete, the same for the same content, or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from errno import EISDIR
from pathlib import Path
from typing import Any

from ..errors import MissingExtraError, PrsError, short

_DATE = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}  # what would make two files of one picture differ


@contextmanager
def matplotlib_told(work: str, extra: str = "plot") -> Iterator[None]:
    """Imports from matplotlib that fail become a MissingExtraError for this work, or a PrsError of a wrong setting."""
    try:
        yield
    except ImportError as error:
        raise MissingExtraError("matplotlib", extra, work) from error
    except ValueError as error:  # a setting of its own that it does not take, such as MPLBACKEND
        raise PrsError(f"matplotlib cannot be used: {error}") from error


def matplotlib_figure(work: str, extra: str = "plot") -> Any:
    """matplotlib's Figure. Raises as matplotlib_told."""
    with matplotlib_told(work, extra):
        from matplotlib.figure import Figure
    return Figure


def check_writable(path: Path) -> None:
    """Raise PrsError now if a file could not be written to `path` later."""
    with told(path):
        if path.is_dir():
            raise IsADirectoryError(EISDIR, "it is a folder")
        _temporary(path).unlink()


def write_figure(figure: Any, path: Path) -> None:
    """Write a matplotlib figure; the file appears only when it is complete. Raises PrsError."""
    from matplotlib import rc_context

    with told(path):
        complete = _temporary(path)
        try:
            with rc_context({"svg.hashsalt": "prs-model"}):
                figure.savefig(complete, dpi=110, metadata=_DATE.get(path.suffix.lower()))
            complete.chmod(0o644)
            complete.replace(path)
        finally:
            complete.unlink(missing_ok=True)


def _temporary(path: Path) -> Path:
    """A new empty file beside `path`."""
    handle, name = tempfile.mkstemp(dir=path.parent, suffix=path.suffix.lower())
    os.close(handle)
    return Path(name)


@contextmanager
def told(path: Path) -> Iterator[None]:
    """Whatever keeps a file from being written becomes a PrsError."""
    try:
        yield
    except OSError as error:
        expected = "expected a file name in a folder that exists and is writable"
        raise PrsError(f"{short(path)}: cannot be written ({error.strerror or error}); {expected}") from error
