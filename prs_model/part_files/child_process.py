"""Readers that may crash, hang or ask for any memory on a damaged file, run in a process of their own with limits.

A reader is run in a fork of one server, which holds what readers import and never reads a file itself: the first read
starts the server and costs its imports, every other one a fork.
"""

from __future__ import annotations

import atexit
import json
import os
import shutil
import socket
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import MissingExtraError, PartFileError

LEAST_MEMORY, MEMORY_PER_BYTE = 1 << 30, 40
LEAST_SECONDS, SECONDS_PER_BYTE = 20.0, 1e-6
STARTING = 120.0  # s, for the server's imports on a busy machine
ADDRESS = "server"

Arrays = dict[str, NDArray[Any]]

_lock = threading.Lock()
_folder: list[Path] = []  # of the server of this process, or of the one it was forked from


def read_apart(
    function: str, *paths: Path, extra: tuple[str, str] | None = None, needs: str | None = None, **arguments: object
) -> Arrays:
    """What ``package.module:function(*paths, **arguments)`` returns, a mapping of arrays, run in a child process.

    The child may use 1 GiB and forty times the files' size, and as much time as such files take. The function raises
    ValueError for a file that is wrong. arguments: what JSON can hold. needs: the module that the function imports;
    extra: the package it is in and the extra that installs it. Raises PartFileError naming the first path, or
    MissingExtraError.
    """
    for path in paths:
        _check_readable(path)
    size = sum(path.stat().st_size for path in paths)
    job = {
        "function": function,
        "paths": [str(path.resolve()) for path in paths],
        "arguments": arguments,
        "needs": needs,
        "memory": LEAST_MEMORY + MEMORY_PER_BYTE * size,
        "seconds": LEAST_SECONDS + SECONDS_PER_BYTE * size,
        "path": sys.path,
    }
    with TemporaryDirectory(prefix="prs-model-") as folder:
        out = Path(folder) / "arrays.npz"
        said = _answer(job | {"out": str(out)}, paths[0])
        if said.get("missing") and extra is not None:
            raise MissingExtraError(*extra, purpose=f"reading {paths[0].name}")
        if "error" in said:
            raise PartFileError(paths[0], str(said["error"]))
        with np.load(out, allow_pickle=False) as file:
            return {name: file[name] for name in file.files}


def _check_readable(path: Path) -> None:
    try:
        with path.open("rb") as file:
            empty = not file.read(1)
    except FileNotFoundError as error:
        raise PartFileError(path, "there is no such file") from error
    except OSError as error:
        raise PartFileError(path, f"cannot be read: {error.strerror or error}") from error
    if empty:
        raise PartFileError(path, "is empty")


def _answer(job: dict[str, Any], path: Path) -> dict[str, Any]:
    """The reader's last word. Raises PartFileError when it has none."""
    begun = time.monotonic()
    with _connection() as connection:
        connection.settimeout(job["seconds"] + STARTING)
        try:
            connection.sendall(json.dumps(job).encode() + b"\n")
            words = b"".join(iter(lambda: connection.recv(1 << 16), b""))
        except OSError:  # out of time, or the server is gone
            words = b""
    if words:
        return dict(json.loads(words))
    if time.monotonic() - begun >= job["seconds"]:
        raise PartFileError(path, f"was not read within {job['seconds']:.0f} s: damaged")
    raise PartFileError(path, "its reader crashed: the file is damaged")


def _connection() -> socket.socket:
    """To the server, which is started when there is none, or it is gone."""
    with _lock:
        for folder in _folder:
            connection = socket.socket(socket.AF_UNIX)
            try:
                connection.connect(str(folder / ADDRESS))
                return connection
            except OSError:
                connection.close()
        _folder[:] = [_start()]
        connection = socket.socket(socket.AF_UNIX)
        connection.connect(str(_folder[0] / ADDRESS))
        return connection


def _start() -> Path:
    """Start a server; it ends with this process. Returns the folder of its address."""
    folder = Path(tempfile.mkdtemp(prefix="prs-model-"))
    threads = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}
    paths = {"PYTHONPATH": os.pathsep.join(entry for entry in sys.path if entry)}
    with socket.socket(socket.AF_UNIX) as listener:
        listener.bind(str(folder / ADDRESS))
        listener.listen(64)
        server = subprocess.Popen(
            [sys.executable, "-P", "-W", "ignore", "-m", "prs_model.part_files.reader_server", str(listener.fileno())],
            stdin=subprocess.PIPE,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            pass_fds=[listener.fileno()],
            env=os.environ | threads | paths,
        )
    atexit.register(_stop, server, folder, os.getpid())
    return folder


def _stop(server: subprocess.Popen[bytes], folder: Path, owner: int) -> None:
    if os.getpid() == owner:
        server.terminate()
        server.wait()
        shutil.rmtree(folder, ignore_errors=True)
