"""The server of `child_process`: imports what readers need, and runs each of them in a fork with limits.

It reads no part file itself, so that a damaged one can do it no harm, and ends when its standard input does.
"""

from __future__ import annotations

import json
import os
import resource
import select
import signal
import socket
import sys
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import short

Job = dict[str, Any]


def serve(listener: socket.socket) -> None:
    """Answer one connection after the other, a line of JSON each; readers run side by side."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # nobody waits for a fork
    while True:
        ready = select.select([listener, sys.stdin.fileno()], [], [])[0]
        if listener not in ready:
            return
        connection = listener.accept()[0]
        with connection, suppress(OSError):
            with connection.makefile() as lines:
                line = lines.readline()
            if line:
                _run(json.loads(line), connection)


def _run(job: Job, connection: socket.socket) -> None:
    """Import for all forks to come, then answer in a fork."""
    sys.path[:] = job["path"]
    try:
        function = _function(job["function"])
        if job["needs"] and find_spec(job["needs"].split(".")[0]) is None:
            _say(connection, {"error": f"the module {job['needs']} is not installed", "missing": True})
            return
        if job["needs"]:
            import_module(job["needs"])
    except Exception as error:
        _say(connection, {"error": f"its reader cannot be used ({type(error).__name__}: {error})"})
        return
    if os.fork() == 0:
        try:
            signal.signal(signal.SIGINT, signal.SIG_DFL)
            signal.alarm(int(job["seconds"]) + 1)
            _limit_memory(int(job["memory"]))
            _say(connection, answer(job, function))
        finally:
            os._exit(0)


def answer(job: Job, function: Callable[..., dict[str, Any]]) -> dict[str, Any]:
    """Run a reader and store its arrays; nothing, or what is wrong with the file."""
    try:
        np.savez(job["out"], **function(*map(Path, job["paths"]), **job["arguments"]))
    except MemoryError:
        return {"error": "asks for far more memory than a file of its size can fill: damaged"}
    except ValueError as error:
        return {"error": short(" ".join(str(error).split()) or "cannot be read", 400)}
    except Exception as error:  # whatever a reader makes of damaged bytes
        what = short(" ".join(str(error).split()), 200)
        return {"error": f"cannot be read, it is damaged or of another kind ({type(error).__name__}: {what})"}
    return {}


def _function(name: str) -> Callable[..., dict[str, Any]]:
    module, function = name.split(":")
    return getattr(import_module(module), function)  # type: ignore[no-any-return]


def _say(connection: socket.socket, words: dict[str, Any]) -> None:
    connection.sendall(json.dumps(words).encode())


def _limit_memory(allowance: int) -> None:
    """At most so many bytes more than there are in use now, where the system can say and hold that."""
    with suppress(OSError, ValueError):
        in_use = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
        most, hard = in_use + allowance, resource.getrlimit(resource.RLIMIT_AS)[1]
        resource.setrlimit(resource.RLIMIT_AS, (most if hard == resource.RLIM_INFINITY else min(most, hard), hard))


if __name__ == "__main__":
    serve(socket.socket(fileno=int(sys.argv[1])))
