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
        self.unit, self.last, self.open = unit, 0.0, False
        self.start = self.first = perf_counter()
        self.already: int | None = None
        self.is_terminal = sys.stderr.isatty()

    def __call__(self, done: int, total: int) -> None:
        now = perf_counter()
        passed = now - self.start
        if self.already is None:  # what comes before the first pose is no part of the rate
            self.first, self.already = now, done
        if passed < _AT_ONCE or passed - self.last < (_EVERY if self.is_terminal else _EVERY_LINE):
            return
        self.last, self.open = passed, True
        text = line(done, total, (done - self.already) / max(now - self.first, 1e-9), self.unit)
        print(f"\r{text}\x1b[K" if self.is_terminal else text, end="" if self.is_terminal else "\n", file=sys.stderr)
        sys.stderr.flush()

    def close(self) -> None:
        """Leave the terminal with a clean line."""
        if self.open and self.is_terminal:
            print("\r\x1b[K", end="", file=sys.stderr, flush=True)


def line(done: int, total: int, rate: float, unit: str) -> str:
    """Such as ``[#####     ]  50%  1,200 of 2,400 poses  600 a second  2 s left``, from a rate per second."""
    share = done / max(total, 1)
    speed = f"{rate:,.0f} a second  {_duration((total - done) / rate)} left" if rate > 0.0 else "started"
    filled = "#" * round(_WIDTH * share)
    return f"[{filled:<{_WIDTH}}] {share:4.0%}  {done:,} of {total:,} {unit}  {speed}"


def _duration(seconds: float) -> str:
    minutes, rest = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes:02d} min" if hours else f"{minutes} min {rest:02d} s" if minutes else f"{rest} s"
