"""One process at a time in a folder."""

from __future__ import annotations

import fcntl
import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from ..errors import PrsError, short

LOCK = "lock"


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Hold a folder. The system lets go of it when the process ends, however it ends.

    The file `lock` in it says who holds it, or held it last. Raises PrsError while another does, OSError for a folder
    that cannot be written.
    """
    with (folder / LOCK).open("a+") as file:
        _take(file.fileno(), folder)
        file.truncate(0)
        file.write(f"process {os.getpid()} on {socket.gethostname()}\n")
        file.flush()
        yield


def _take(descriptor: int, folder: Path) -> None:
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError as error:
        holder = (folder / LOCK).read_text().strip() or "another process"
        raise PrsError(f"{short(folder)}: in use by {holder}; wait until it ends, or name another folder") from error
    except OSError as error:
        why = error.strerror or error
        raise PrsError(f"{short(folder)}: its file system knows no locks ({why}); name a folder on another") from error
