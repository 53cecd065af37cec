"""How many nodes an axis needs, from the terms along lines: how many are large, and how fast the rest falls."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil, log

import numpy as np

from ...arrays import FloatArray
from .spectral import LAST, Axis

_SLOWEST, _FASTEST = 0.85, 0.2  # fall that is reckoned with


@dataclass(frozen=True)
class Need:
    """Nodes along an axis, and the factor by which the error falls with each further one."""

    count: int
    fall: float

    def more(self, count: int, excess: float) -> int:
        """Nodes in place of `count` that bring down an error which is too large by the factor `excess`."""
        return count + max(1, ceil(log(excess) / -log(self.fall)))


def need(axis: Axis, matrices: FloatArray, most: float, beyond: float) -> Need | None:
    """Nodes for which what is left out is below `most`, of matrices (c, n, e) at the n nodes on c lines.

    Up to `beyond` times as many as the lines have are reckoned from how the terms fall; None where these are too few.
    """
    sizes = np.linalg.norm(axis.transform @ matrices, axis=2).max(axis=0)
    rest = np.cumsum(sizes[::-1])[::-1]
    last = len(rest) - LAST[axis.kind]
    first = int(np.flatnonzero(rest < most)[0]) if rest[last] < most else last
    before = first // 2
    fall = (rest[first] / rest[before]) ** (1.0 / (first - before)) if first else _FASTEST
    found = Need(first + 2, float(np.clip(fall, _FASTEST, _SLOWEST)))
    if rest[first] >= most:
        found = Need(found.more(first + 2, rest[first] / most), found.fall)
    return found if found.count <= beyond * len(rest) else None
