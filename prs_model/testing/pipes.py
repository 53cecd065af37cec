"""What a forked child has to say, and how it ended."""

from __future__ import annotations

import os
import select
import signal
import time


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
