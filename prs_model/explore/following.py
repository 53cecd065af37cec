"""Which mode of the start each mode is now, known by its shape."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..modes import Modes
from ..modes.mac import in_common, observe, pairing

_ALIKE = 0.5  # MAC from which a mode is said to be another one


@dataclass(frozen=True)
class Origin:
    """The mode of the start with the same shape: its number, counted from 1, and how far the frequency is from its
    own, as a share; None for a rigid-body mode."""

    number: int
    change: float | None


def origins(start: Modes, found: Modes) -> tuple[Origin | None, ...]:
    """Where each mode found comes from; None for a shape that none of the start's comes near.

    start: as many modes as were found, or more. Modes of equal frequency are compared as the plane that they span.
    """
    pairs = pairing(*in_common(observe(found), observe(start)), found.frequencies, start.frequencies)
    return tuple(
        _origin(start.frequencies[partner], frequency, int(partner)) if likeness >= _ALIKE else None
        for partner, frequency, likeness in zip(pairs.partners, found.frequencies, np.diag(pairs.mac), strict=True)
    )


def _origin(before: float, now: float, partner: int) -> Origin:
    return Origin(partner + 1, float(now / before - 1.0) if before > 0.0 else None)
