"""Reads one part after the other, each in a forked child with limits on time and memory. Run as a program.

A JSON object with `jobs` (arguments of `Sample`), `seconds` and `memory` on standard input; the first job is the whole
part. A line of JSON per job on standard output: result, message, difference, seconds, surprises.
"""

from __future__ import annotations

import contextlib
import json
import os
import resource
import signal
import sys
import time
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from ..errors import PluginError, PrsError
from ..reduction import SuperElement
from ..reduction.summary import summarize
from .pipes import ending, read_all
from .receptance import Whole
from .sample import Sample

Answer = dict[str, Any]
Jobs = list[dict[str, Any]]


def main() -> None:
    task = json.loads(sys.stdin.buffer.read())
    answers = os.dup(1)
    os.dup2(2, 1)  # whatever a reader prints is no answer
    jobs: Jobs = task["jobs"]
    element = Sample(**jobs[0]).reduce()
    whole, known = Whole(element), set(_surprises(element))
    for job in jobs[1:]:
        answer = _forked(job, whole, known, task["seconds"], task["memory"])
        os.write(answers, (json.dumps(answer) + "\n").encode())


def _forked(job: Mapping[str, Any], whole: Whole, known: set[str], seconds: float, memory: int) -> Answer:
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


def _child(job: Mapping[str, Any], whole: Whole, known: set[str], memory: int, writing: int) -> None:
    """Never returns."""
    try:
        os.setpgid(0, 0)
        _limit(memory)
        answer = _outcome(Sample(**job), whole, known)
        os.write(writing, json.dumps(answer).encode())
    finally:
        os._exit(1)


def _outcome(sample: Sample, whole: Whole, known: set[str]) -> Answer:
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
    surprises = [each for each in _surprises(element) if each not in known]
    return {"result": "read", "message": "", "difference": whole.difference(element), "surprises": surprises}


def _surprises(element: SuperElement) -> tuple[str, ...]:
    """What is said of a part's figures; a warning about anything else notices no damage."""
    try:
        return summarize(element, 1).surprises
    except PrsError as error:
        return (str(error),)


def _limit(memory: int) -> None:
    """At most so many bytes more than now, where the system can say and hold that."""
    with contextlib.suppress(OSError, ValueError):
        in_use = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        resource.setrlimit(resource.RLIMIT_AS, (in_use + memory, resource.getrlimit(resource.RLIMIT_AS)[1]))


if __name__ == "__main__":
    main()
