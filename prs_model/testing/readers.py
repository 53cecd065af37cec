"""Readers that run in a child process, with what they import already there: starting each afresh takes a second."""

from __future__ import annotations

import json
import os
import signal
import time
import warnings
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import PartFileError
from ..part_files import child_process
from .pipes import ending, read_all, standard_output_to

Job = dict[str, Any]


def run_here(job: Job, out: Path, seconds: float, path: Path) -> dict[str, Any]:
    """For undamaged parts: in this process, which then has loaded what the reader needs."""
    module, name = job["function"].split(":")
    with warnings.catch_warnings(), standard_output_to(2):  # as in a process of its own
        warnings.simplefilter("ignore")
        function: Callable[..., dict[str, Any]] = getattr(import_module(module), name)
        np.savez(out, allow_pickle=False, **function(*map(Path, job["paths"]), **job["arguments"]))
    return {}


def run_forked(job: Job, out: Path, seconds: float, path: Path) -> dict[str, Any]:
    """What `read_apart` does with its child, the child being a fork of this process. Raises PartFileError."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            os.close(reading)
            os.write(writing, json.dumps(child_process._answer(job, out)).encode())
        finally:
            os._exit(1)
    os.close(writing)
    said, late = read_all(reading, time.monotonic() + seconds)
    os.close(reading)
    os.kill(child, signal.SIGKILL)
    status = os.waitpid(child, 0)[1]
    if said:
        return dict(json.loads(said))
    if late:
        raise PartFileError(path, f"was not read within {seconds:.0f} s: damaged")
    raise PartFileError(path, f"its reader crashed ({ending(status)}): the file is damaged")


def use(run: Callable[[Job, Path, float, Path], dict[str, Any]]) -> None:
    """Have `read_apart` run its jobs so, in this process and its forks."""
    vars(child_process)["_run"] = run
