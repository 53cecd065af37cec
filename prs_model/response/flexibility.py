"""Modal flexibility, its share of the static compliance, and the weak modes (eq. 20-22)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError
from .points import point
from .quantity import DIRECTIONS
from .static import static_compliance

if TYPE_CHECKING:
    from ..modes import Character, Modes

_PROMINENT = 0.25


@dataclass(frozen=True)
class WeakMode:
    """A mode that gives much of the static compliance of the end-reference point in one direction.

    number: from 1; share: of the compliance; flexibility [m/N or rad/(N m)]; character: what moves.
    """

    direction: str
    number: int
    frequency: float
    share: float
    flexibility: float
    character: Character

    def __str__(self) -> str:
        about = f"about {self.direction[1:]}" if self.direction.startswith("r") else f"along {self.direction}"
        what = f"{self.character.group} {self.character.motion}"
        return f"mode {self.number} ({self.frequency:.1f} Hz), {what}, gives {self.share:.0%} of the compliance {about}"


def modal_flexibility(modes: Modes) -> FloatArray:
    """(f_C,i)_k = phi_Ci,k^2 / lambda_k (k, 6) [m/N, rad/(N m)], eq. (20). Raises PrsError for a mode at 0 Hz."""
    if modes.is_rigid.any():
        raise PrsError("modes at 0 Hz have no flexibility: the machine can move without straining anything")
    return np.asarray((modes.output_shapes**2 / modes.eigenvalues).T)


def flexibility_shares(modes: Modes) -> FloatArray:
    """(f_C,i)_k / C_i (k, 6), eq. (21), of the exact static compliance; 0 where that is 0.

    What the shares of a direction lack of 1 is the truncation of the modal sum.
    """
    flexibility = modal_flexibility(modes)
    output = point(modes.system)
    total = np.diag(static_compliance(modes.system, output, output))
    return np.asarray(np.where(total > 0.0, flexibility / np.where(total > 0.0, total, 1.0), 0.0))


def weak_modes(modes: Modes) -> tuple[WeakMode, ...]:
    """For each direction the modes that give more than a quarter of its compliance, at least the first, by share."""
    flexibility, shares, characters = modal_flexibility(modes), flexibility_shares(modes), modes.characters()
    found = []
    for axis, direction in enumerate(DIRECTIONS):
        ranked = np.argsort(-shares[:, axis], kind="stable")
        for place, k in enumerate(ranked):
            share = float(shares[k, axis])
            if share > _PROMINENT or (place == 0 and share > 0.0):
                frequency, given = float(modes.frequencies[k]), float(flexibility[k, axis])
                found.append(WeakMode(direction, int(k) + 1, frequency, share, given, characters[k]))
    return tuple(found)
