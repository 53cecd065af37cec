"""Modes of equal frequency: any turn of their shapes is as good, so one is chosen that says something."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ..arrays import FloatArray, IntArray
from ..synthesis.system import System

GAP = 0.01
"""Modes whose frequencies differ by less than this share are one cluster to compare models by. A change of the model
that moves frequencies by a share d turns two modes a gap g apart into each other by an angle of about d / g, so that
models which agree to one per cent cannot tell modes apart that are closer than that."""

EQUAL = 1e-5
"""Frequencies closer than this share are equal: what parts them is how like limbs were meshed, and round-off."""

_MOVES = 1e-4  # of the largest motion of the end-reference point in any mode
_COMPARABLE = 0.5  # of the largest motion of a group along any axis


def clusters(frequencies: FloatArray, gap: float = GAP) -> IntArray:
    """The cluster number (n,) of ascending frequencies: neighbours closer than the relative gap share one."""
    apart = np.diff(frequencies) > gap * np.asarray(frequencies)[1:]
    return np.concatenate([[0], np.cumsum(apart)])


def groups(numbers: IntArray) -> Iterator[IntArray]:
    """The places of each cluster."""
    return (np.flatnonzero(numbers == number) for number in np.unique(numbers))


def repeated(frequencies: FloatArray) -> list[IntArray]:
    """The places of modes of equal frequency, several each."""
    return [some for some in groups(clusters(frequencies, EQUAL)) if len(some) > 1]


def principal_shapes(system: System, frequencies: FloatArray, shapes: FloatArray) -> FloatArray:
    """Shapes (n, k), those of equal frequency turned to axes of what the end-reference point does in them.

    The first of them has all their motion along u, the next what is left along v, and so on through w, rotations and
    the coordinates themselves, axes with little motion last. Each moves that way in the positive sense.
    """
    turned = shapes.copy()
    motion = system.output @ shapes
    inertia = np.sqrt(np.maximum(np.diag(system.mass), 0.0))[:, None] * shapes
    for some in repeated(frequencies):
        seen = [(rows[:, some], _MOVES * np.abs(rows).max()) for rows in (motion[:3], motion[3:], inertia)]
        turned[:, some] = shapes[:, some] @ _turn(seen, len(some))
    return turned


def parted_shapes(stiffness: FloatArray, frequencies: FloatArray, shapes: FloatArray) -> FloatArray:
    """Shapes (n, k), those of almost equal frequency turned back to the eigenvectors, which do without each other."""
    parted = shapes.copy()
    for some in repeated(frequencies):
        parted[:, some] = shapes[:, some] @ np.linalg.eigh(shapes[:, some].T @ stiffness @ shapes[:, some])[1]
    return parted


def _turn(seen: list[tuple[FloatArray, float]], count: int) -> FloatArray:
    """(k, k) orthogonal: axes found in rows (r, k) one group after the other, each with what counts as no motion."""
    axes = np.zeros((count, 0))
    for rows, least in seen:
        while axes.shape[1] < count:
            left = rows - rows @ axes @ axes.T
            size = np.linalg.norm(left, axis=1)
            if size.max() <= least:
                break
            row = left[np.argmax(size >= _COMPARABLE * size.max())]
            axes = np.column_stack([axes, row / np.linalg.norm(row)])
    rest = np.linalg.qr(np.column_stack([axes, np.eye(count)]))[0][:, axes.shape[1] : count]
    return np.column_stack([axes, rest])
