"""Modal flexibility, its share of the static compliance, and the weak modes (eq. 20-22)."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray, IntArray
from ..errors import PrsError
from ..modes.character import shares_by_group
from ..modes.clusters import EQUAL, clusters, groups
from .points import point
from .quantity import DIRECTIONS, real_numbers
from .static import static_compliance

if TYPE_CHECKING:
    from ..modes import Character, Modes
    from ..modes.energy import Energies


@dataclass(frozen=True)
class WeakMode:
    """A mode that gives much of the static compliance of a node in one direction, or several of equal frequency.

    numbers: from 1, `number` the one that gives most; share: of the compliance; flexibility [m/N or rad/(N m)];
    character: what moves; strained: the kind of body or joint with most of the strain energy, and its share of that.
    """

    direction: str
    number: int
    frequency: float
    share: float
    flexibility: float
    character: Character
    numbers: tuple[int, ...]
    strained: tuple[str, float]

    def __str__(self) -> str:
        about = f"about {self.direction[1:]}" if self.direction.startswith("r") else f"along {self.direction}"
        several = len(self.numbers) > 1
        modes = f"modes {' and '.join(map(str, self.numbers))}" if several else f"mode {self.number}"
        gives = "together give" if several else "gives"
        what = f"{self.character.group} {self.character.motion}"
        where = f"{self.strained[1]:.0%} of {'their' if several else 'its'} strain in {self.strained[0]}"
        share = f"{self.share:.0%} of the compliance {about}"
        return f"{modes} ({self.frequency:.1f} Hz), {what}, {gives} {share}; {where}"


def modal_flexibility(modes: Modes, at: str | None = None) -> FloatArray:
    """(f_C,i)_k = phi_Ci,k^2 / lambda_k (k, 6) [m/N, rad/(N m)], eq. (20). Raises PrsError for a mode at 0 Hz."""
    if modes.is_rigid.any():
        raise PrsError("modes at 0 Hz have no flexibility: the machine can move without straining anything")
    return np.asarray(((point(modes.system, at).motion @ modes.shapes) ** 2 / modes.eigenvalues).T)


def flexibility_shares(modes: Modes, at: str | None = None) -> FloatArray:
    """(f_C,i)_k / C_i (k, 6), eq. (21), of the exact static compliance; 0 where that is 0.

    What the shares of a direction lack of 1 is the truncation of the modal sum.
    """
    flexibility = modal_flexibility(modes, at)
    node = point(modes.system, at)
    total = np.diag(static_compliance(modes.system, node, node))
    return np.asarray(np.where(total > 0.0, flexibility / np.where(total > 0.0, total, 1.0), 0.0))


def weak_modes(modes: Modes, at: str | None, least: float) -> tuple[WeakMode, ...]:
    """See Modes.weak_modes."""
    expected = "a share above 0 and below 1"
    limit = real_numbers("least", least, expected)
    if limit.ndim or not 0.0 < limit < 1.0:
        raise PrsError(f"least: found {least}, expected {expected}")
    flexibility, shares = modal_flexibility(modes, at), flexibility_shares(modes, at)
    said = _Said(modes, modes.characters(), modes.strain_energy())
    alike = list(groups(clusters(modes.frequencies, EQUAL)))
    found = []
    for axis, direction in enumerate(DIRECTIONS):
        together = np.array([shares[some, axis].sum() for some in alike])
        for place in np.argsort(-together, kind="stable"):
            if together[place] >= limit or together[place] == together.max() > 0.0:
                found.append(said.weak_mode(direction, alike[place], flexibility[:, axis], float(together[place])))
    return tuple(found)


@dataclass(frozen=True)
class _Said:
    """What there is to say of the modes of a system."""

    modes: Modes
    characters: tuple[Character, ...]
    strain: Energies

    def weak_mode(self, direction: str, some: IntArray, flexibility: FloatArray, share: float) -> WeakMode:
        most = int(some[np.argmax(flexibility[some])])
        return WeakMode(
            direction=direction,
            number=most + 1,
            frequency=float(self.modes.frequencies[most]),
            share=share,
            flexibility=float(flexibility[some].sum()),
            character=self.characters[most],
            numbers=tuple(int(k) + 1 for k in some),
            strained=self._most_strained(some, flexibility[some] / flexibility[some].sum()),
        )

    def _most_strained(self, some: IntArray, weights: FloatArray) -> tuple[str, float]:
        system = self.modes.system
        energy = {name: float(each[some] @ weights) for name, each in self.strain.items()}
        name, share = next(iter(shares_by_group(energy, system.stems).items()))
        bodies = {system.stems.get(body, body) for body in system.elements}
        return name if name in bodies or name.startswith("joint ") else f"joint {name}", share
