"""Descriptors: what a forked child has to say, how it ended, and where standard output goes."""

from __future__ import annotations

import os
import select
import signal
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager


def read_all(reading: int, until: float) -> tuple[bytes, bool]:
    """Everything a pipe gives before its end, and whether time [s, monotonic] ran out."""
    parts: list[bytes] = []
    while (left := until - time.monotonic()) > 0.0:
        if not select.select([reading], [], [], left)[0]:
            break
        part = os.read(reading, 1 << 16)
        if not part:
            return b"".join(parts), False
        parts.append(part)
    return b"", True


def ending(status: int) -> str:
    """Such as ``SIGSEGV`` or ``exit status 1``."""
    code = os.waitstatus_to_exitcode(status)
    return signal.Signals(-code).name if code < 0 else f"exit status {code}"


@contextmanager
def standard_output_to(descriptor: int) -> Iterator[None]:
    """Standard output, that of compiled code too, goes elsewhere for a while."""
    sys.stdout.flush()
    kept = os.dup(1)
    os.dup2(descriptor, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)
        os.close(kept)
