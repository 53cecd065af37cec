"""One process at a time in a folder."""

from __future__ import annotations

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ...errors import PrsError, short

LOCK = "lock"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder. The system lets go of it when the process ends, however it ends.

    The file `lock` in it says who holds it, or held it last. Raises PrsError while another does, and where the
    system has no such locks; OSError for a folder that cannot be written.
    """
    try:
        import fcntl  # noqa: F401  (POSIX only)
    except ImportError as error:
        why = "this system has no file locks (fcntl), by which one process at a time is let in"
        raise PrsError(f"{short(folder)}: {why}; sweep without a folder (store), or on Linux or macOS") from error
    with (folder / LOCK).open("a+") as file:
        _take(file.fileno(), folder)
        file.truncate(0)
        file.write(f"process {os.getpid()} on {socket.gethostname()}\n")
        file.flush()
        yield


def _take(descriptor: int, folder: Path) -> None:
    import fcntl

    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        holder = (folder / LOCK).read_text().strip() or "another process"
        raise PrsError(f"{short(folder)}: in use by {holder}; wait until it ends, or name another folder") from error
    except OSError as error:
        why = error.strerror or error
        raise PrsError(f"{short(folder)}: its file system knows no locks ({why}); name a folder on another") from error
