"""Readers that may crash, hang or ask for any memory on a damaged file, run in a process of their own with limits."""

from __future__ import annotations

import contextlib
import io
import json
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import MissingExtraError, PartFileError, short

LEAST_MEMORY, MEMORY_PER_BYTE = 1 << 30, 40
LEAST_SECONDS, SECONDS_PER_BYTE = 20.0, 1e-6

Arrays = dict[str, NDArray[Any]]


def read_apart(function: str, *paths: Path, extra: tuple[str, str] | None = None, **arguments: object) -> Arrays:
    """What ``package.module:function(*paths, **arguments)`` returns, a mapping of arrays, run in a child process.

    The child may use 1 GiB and forty times the files' size, and as much time as such files take. The function raises
    ValueError for a file that is wrong. arguments: what JSON can hold. extra: the package that the function needs and
    the extra that installs it. Raises PartFileError naming the first path, or MissingExtraError.
    """
    for path in paths:
        _check_readable(path)
    size = sum(path.stat().st_size for path in paths)
    job = {
        "function": function,
        "paths": [str(path.resolve()) for path in paths],
        "arguments": arguments,
        "memory": LEAST_MEMORY + MEMORY_PER_BYTE * size,
    }
    with TemporaryDirectory(prefix="prs-model-") as folder:
        out = Path(folder) / "arrays.npz"
        said = _run(job, out, LEAST_SECONDS + SECONDS_PER_BYTE * size, paths[0])
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


def _run(job: dict[str, Any], out: Path, seconds: float, path: Path) -> dict[str, Any]:
    """The child's last word. What it prints otherwise is dropped."""
    environment = os.environ | {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "MKL_NUM_THREADS": "1"}
    environment["PYTHONPATH"] = os.pathsep.join(entry for entry in sys.path if entry)
    command = [sys.executable, "-m", __name__, str(out)]
    try:
        done = subprocess.run(
            command, input=json.dumps(job).encode(), capture_output=True, timeout=seconds, env=environment, check=False
        )
    except subprocess.TimeoutExpired as error:
        raise PartFileError(path, f"was not read within {seconds:.0f} s: damaged") from error
    if done.returncode != 0:
        raise PartFileError(path, f"its reader crashed (exit status {done.returncode}): the file is damaged")
    said = json.loads(done.stdout.splitlines()[-1])
    return dict(said)


def _main(out: Path) -> None:
    job = json.loads(sys.stdin.buffer.read())
    answer = os.dup(1)
    os.dup2(2, 1)  # compiled readers print to descriptor 1
    said = _answer(job, out)
    os.write(answer, (json.dumps(said) + "\n").encode())


def _answer(job: dict[str, Any], out: Path) -> dict[str, Any]:
    from importlib import import_module

    module, name = job["function"].split(":")
    try:
        function = getattr(import_module(module), name)
        _limit_memory(int(job["memory"]))
        with contextlib.redirect_stdout(io.StringIO()):
            arrays = function(*map(Path, job["paths"]), **job["arguments"])
        np.savez(out, allow_pickle=False, **arrays)
    except ModuleNotFoundError as error:
        return {"error": f"{error}", "missing": True}
    except MemoryError:
        return {"error": "asks for far more memory than a file of its size can fill: damaged"}
    except ValueError as error:
        return {"error": short(" ".join(str(error).split()) or "cannot be read", 400)}
    except Exception as error:  # whatever a reader makes of damaged bytes
        what = short(" ".join(str(error).split()), 200)
        return {"error": f"cannot be read, it is damaged or of another kind ({type(error).__name__}: {what})"}
    return {}


def _limit_memory(allowance: int) -> None:
    """At most so many bytes more than there are in use now, where the system can say and hold that."""
    try:
        import resource

        in_use = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    except (ImportError, OSError):
        return
    resource.setrlimit(resource.RLIMIT_AS, (in_use + allowance, in_use + allowance))


if __name__ == "__main__":
    _main(Path(sys.argv[1]))
