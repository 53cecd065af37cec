"""A bar on standard error: how much is done, how fast, how long it will take."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter

_WIDTH = 30
_EVERY = 0.1  # seconds between two drawings on a terminal
_EVERY_LINE = 10.0  # and between two lines where the bar cannot be drawn over itself
_AT_ONCE = 0.5  # seconds below which nothing is drawn


@contextmanager
def bar(*, quiet: bool, unit: str) -> Iterator[Callable[[int, int], None] | None]:
    """What is called with how many are done and how many there are; None when nothing is to be said."""
    if quiet:
        yield None
        return
    drawn = _Bar(unit)
    try:
        yield drawn
    finally:
        drawn.close()


class _Bar:
    """Drawn over itself on a terminal, a line now and then elsewhere."""

    def __init__(self, unit: str):
        self.unit, self.start, self.last, self.open = unit, perf_counter(), 0.0, False
        self.is_terminal = sys.stderr.isatty()

    def __call__(self, done: int, total: int) -> None:
        passed = perf_counter() - self.start
        if passed < _AT_ONCE or passed - self.last < (_EVERY if self.is_terminal else _EVERY_LINE):
            return
        self.last, self.open = passed, True
        text = line(done, total, passed, self.unit)
        print(f"\r{text}\x1b[K" if self.is_terminal else text, end="" if self.is_terminal else "\n", file=sys.stderr)
        sys.stderr.flush()

    def close(self) -> None:
        """Leave the terminal with a clean line."""
        if self.open and self.is_terminal:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def line(done: int, total: int, seconds: float, unit: str) -> str:
    """Such as ``[#####     ]  50 %  1,200 of 2,400 poses  600 a second  2 s left``."""
    share = done / max(total, 1)
    rate = done / max(seconds, 1e-9)
    left = _duration((total - done) / rate) if done else "?"
    filled = "#" * round(_WIDTH * share)
    return f"[{filled:<{_WIDTH}}] {share:4.0%}  {done:,} of {total:,} {unit}  {rate:,.0f} a second  {left} left"


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"
