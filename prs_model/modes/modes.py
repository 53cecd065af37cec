"""Natural modes of a system and where their energy sits."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from ..arrays import BoolArray, FloatArray
from ..errors import PrsError
from ..linear_algebra import lowest_modes, slowest_rate
from ..synthesis.system import System
from .character import Character, characters

_RIGID = 1e-8


@dataclass(frozen=True, eq=False, repr=False)
class Modes:
    """Natural frequencies [Hz] ascending and mass-normalised shapes (n, k) on the system's coordinates."""

    system: System
    eigenvalues: FloatArray
    shapes: FloatArray

    def __repr__(self) -> str:
        return f"Modes({', '.join(f'{f:.4g}' for f in self.frequencies)} Hz)"

    @property
    def frequencies(self) -> FloatArray:
        """(k,) [Hz]; zero for rigid-body modes."""
        return np.asarray(np.sqrt(np.where(self.is_rigid, 0.0, self.eigenvalues)) / (2.0 * np.pi))

    @cached_property
    def is_rigid(self) -> BoolArray:
        """(k,) whether a mode strains nothing: its eigenvalue is round-off beside those of the held coordinates."""
        return np.asarray(self.eigenvalues <= _RIGID * slowest_rate(self.system.mass, self.system.stiffness))

    @property
    def output_shapes(self) -> FloatArray:
        """(6, k): motion of the end-reference point in the output frame, translations first."""
        return self.system.output @ self.shapes

    def body_shapes(self, body: str) -> FloatArray:
        """(m, k): the shapes on one body's own coordinates, in its body frame."""
        return self.system.expansion[self.system.blocks[body]] @ self.shapes

    def kinetic_energy(self) -> dict[str, FloatArray]:
        """Share (k,) of each mode's kinetic energy in each body; the shares of a mode sum to one (eq. 22)."""
        return _shares({name: _quadratic(self.body_shapes(name), e.mass) for name, e in self.system.elements.items()})

    def strain_energy(self) -> dict[str, FloatArray]:
        """Share (k,) of each mode's strain energy in each body and each joint; the shares of a mode sum to one.

        Rigid-body modes have none: their shares are zero.
        """
        bodies = {name: _quadratic(self.body_shapes(name), e.stiffness) for name, e in self.system.elements.items()}
        energy = bodies | self._joint_energy()
        return _shares({name: np.where(self.is_rigid, 0.0, part) for name, part in energy.items()})

    def characters(self) -> tuple[Character, ...]:
        """What moves in each mode, and along or about what."""
        return characters(self.system, self.shapes)

    def _joint_energy(self) -> dict[str, FloatArray]:
        energy: dict[str, FloatArray] = {}
        for spring in self.system.springs:
            strain = spring.displacement @ (self.system.expansion[spring.rows] @ self.shapes)
            energy[spring.joint] = energy.get(spring.joint, 0.0) + _quadratic(strain, spring.stiffness)
        return energy


def modes_of(system: System, count: int) -> Modes:
    """The lowest `count` modes of a system. Raises PrsError when `count` is not a whole number above zero."""
    check_count(count)
    labels = [" ".join(filter(None, row)) for row in system.index]
    return Modes(system, *lowest_modes(system.mass, system.stiffness, int(count), labels))


def check_count(count: object) -> None:
    """Raises PrsError when so many modes cannot be asked for."""
    if not isinstance(count, int | np.integer) or isinstance(count, bool) or count < 1:
        raise PrsError(f"found {count!r} modes asked for, expected a whole number above zero")


def _quadratic(shapes: FloatArray, matrix: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("ik,ij,jk->k", shapes, matrix, shapes, optimize=True))


def _shares(energy: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
    total = np.asarray(sum(energy.values()))
    positive = total > 0
    return {name: np.where(positive, part / np.where(positive, total, 1.0), 0.0) for name, part in energy.items()}
