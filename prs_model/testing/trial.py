"""Reads one part after the other, each in a forked child with limits on time and memory. Run as a program.

A JSON object with `jobs` (arguments of `Sample`), `seconds` and `memory` on standard input; the first job is the whole
part. A line of JSON per job on standard output: result, message, difference, seconds, warnings.
"""

from __future__ import annotations

import contextlib
import json
import logging
import os
import resource
import signal
import sys
import time
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import FloatArray
from ..errors import PluginError, PrsError
from ..reduction import SuperElement
from .pipes import ending, read_all
from .receptance import difference, first_eigenvalue, receptances
from .sample import Sample

Answer = dict[str, Any]
Jobs = list[dict[str, Any]]


class _Whole:
    """What the undamaged part is like."""

    def __init__(self, element: SuperElement):
        self.nodes = sorted(element.nodes)
        self.positions = _positions(element)
        self.eigenvalue = first_eigenvalue(element)
        self.receptances = receptances(element, self.eigenvalue)

    def difference(self, element: SuperElement) -> float:
        """Zero for the same part; infinite for one with other nodes."""
        if sorted(element.nodes) != self.nodes:
            return float("inf")
        size = float(np.ptp(self.positions, axis=0).max(initial=0.0)) or 1.0
        moved = float(np.max(np.abs(_positions(element) - self.positions), initial=0.0)) / size
        return max(moved, difference(receptances(element, self.eigenvalue), self.receptances))


def _positions(element: SuperElement) -> FloatArray:
    return element.positions[np.argsort(element.nodes)]


def main() -> None:
    task = json.loads(sys.stdin.buffer.read())
    answers = os.dup(1)
    os.dup2(2, 1)  # whatever a reader prints is no answer
    jobs: Jobs = task["jobs"]
    with _warnings() as warned:
        whole = _Whole(Sample(**jobs[0]).reduce())
    for job in jobs[1:]:
        answer = _forked(job, whole, set(warned), task["seconds"], task["memory"])
        os.write(answers, (json.dumps(answer) + "\n").encode())


def _forked(job: Mapping[str, Any], whole: _Whole, known: set[str], seconds: float, memory: int) -> Answer:
    """The child's answer, or what became of the child."""
    begun = time.monotonic()
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        _child(job, whole, known, memory, writing)
    os.close(writing)
    said, late = read_all(reading, begun + seconds)
    os.close(reading)
    with contextlib.suppress(ProcessLookupError):
        os.killpg(child, signal.SIGKILL)  # with the readers it may have started
    status = os.waitpid(child, 0)[1]
    took = {"seconds": time.monotonic() - begun}
    if said:
        return {**json.loads(said), **took}
    if late:
        return {"result": "hang", "message": f"not read within {seconds:.0f} s", **took}
    return {"result": "crash", "message": f"the process ended with {ending(status)}", **took}


def _child(job: Mapping[str, Any], whole: _Whole, known: set[str], memory: int, writing: int) -> None:
    """Never returns."""
    try:
        os.setpgid(0, 0)
        _limit(memory)
        with _warnings() as warned:
            answer = _outcome(Sample(**job), whole)
        answer["warnings"] = [message for message in warned if message not in known]
        os.write(writing, json.dumps(answer).encode())
    finally:
        os._exit(1)


def _outcome(sample: Sample, whole: _Whole) -> Answer:
    try:
        element = sample.reduce()
    except PluginError as error:
        return {"result": "crash", "message": str(error)}
    except PrsError as error:
        return {"result": "refused", "message": str(error)}
    except MemoryError:
        return {"result": "memory", "message": "asks for more memory than it may have"}
    except BaseException as error:
        return {"result": "crash", "message": f"{type(error).__name__}: {error}"}
    return {"result": "read", "message": "", "difference": whole.difference(element)}


def _limit(memory: int) -> None:
    """At most so many bytes more than now, where the system can say and hold that."""
    with contextlib.suppress(OSError, ValueError):
        in_use = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (in_use + memory, resource.getrlimit(resource.RLIMIT_AS)[1]))


class _Kept(logging.Handler):
    def __init__(self, kept: list[str]):
        super().__init__(logging.WARNING)
        self.kept = kept

    def emit(self, record: logging.LogRecord) -> None:
        self.kept.append(record.getMessage())


@contextlib.contextmanager
def _warnings() -> Iterator[list[str]]:
    """The warnings that are logged, as a list that grows."""
    kept: list[str] = []
    handler, logger = _Kept(kept), logging.getLogger("prs_model")
    logger.addHandler(handler)
    try:
        yield kept
    finally:
        logger.removeHandler(handler)


if __name__ == "__main__":
    main()
