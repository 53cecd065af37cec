"""The box around a whole part, which a reduced element takes along in its provenance."""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from .super_element import SuperElement

ENTRY = "box"


def box_text(points: FloatArray) -> str:
    """The box around points (p, 3) [m] as text: lowest x, y, z, then highest."""
    return " ".join(f"{x:.9g}" for x in (*points.min(axis=0), *points.max(axis=0)))


def corners_of(element: SuperElement) -> FloatArray | None:
    """(2, 3) [m]: the corners of the box around the part that was reduced here; None of others."""
    numbers = element.provenance.get(ENTRY, "").split()
    return np.array(numbers, dtype=float).reshape(2, 3) if len(numbers) == 6 else None
