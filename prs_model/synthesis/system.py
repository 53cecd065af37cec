"""The synthesised system: M, C, K with a label on every row, and the way back to each body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray, IntArray
from ..description.schema import Damping
from ..kinematics import Configuration
from ..reduction import SuperElement

if TYPE_CHECKING:
    from ..modes import Modes


class Coordinate(NamedTuple):
    """What one row of the system is: a node's displacement or rotation in body axes, or a modal coordinate."""

    body: str
    node: str
    dof: str


@dataclass(frozen=True, eq=False)
class SpringMotion:
    """Relative displacement D (6, k) of a spring's ends on body coordinates `rows` (k,), and its stiffness (6, 6)."""

    joint: str
    interface: str | None
    rows: IntArray
    displacement: FloatArray
    stiffness: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class System:
    """M u'' + C u' + K u = f in one configuration (eq. 16, 17), SI units, displacements in body axes.

    `expansion` (N, n) gives all N body coordinates from the n independent ones; it is the identity where no joint
    is rigid. `blocks` are the rows of each body among the N. `output` (6, n) reads the end-reference point, a node of
    `output_body`, in the axes of the output frame; `output_placement` is where it stands in the world, `placements`
    where the bodies do.
    """

    mass: FloatArray
    stiffness: FloatArray
    index: tuple[Coordinate, ...]
    expansion: FloatArray
    blocks: Mapping[str, slice]
    elements: Mapping[str, SuperElement]
    springs: tuple[SpringMotion, ...]
    output: FloatArray
    output_body: str
    output_placement: pin.SE3
    placements: Mapping[str, pin.SE3]
    configuration: Configuration
    stems: Mapping[str, str]
    damping_model: Damping

    def __post_init__(self) -> None:
        for matrix in (self.mass, self.stiffness, self.expansion, self.output):
            matrix.setflags(write=False)

    def __repr__(self) -> str:
        return f"System({self.size} coordinates, {len(self.elements)} bodies, {len(self.springs)} springs)"

    @property
    def size(self) -> int:
        """Number of independent coordinates."""
        return len(self.index)

    @cached_property
    def damping(self) -> FloatArray:
        """C (n, n) [N s/m and so on]: Rayleigh's alpha M + beta K, or M Phi diag(2 xi omega) Phi^T M over all modes."""
        if self.damping_model.rayleigh is not None:
            rayleigh = self.damping_model.rayleigh
            return np.asarray(rayleigh.alpha * self.mass + rayleigh.beta * self.stiffness)
        ratio = self.damping_model.modal or 0.0
        modes = self.modes(self.size)
        omega = 2.0 * np.pi * modes.frequencies
        momentum = self.mass @ modes.shapes
        return np.asarray((momentum * (2.0 * ratio * omega)) @ momentum.T)

    def modes(self, count: int = 8) -> Modes:
        """The lowest `count` natural modes (fewer where the mass matrix has a lower rank)."""
        from ..modes import modes_of

        return modes_of(self, count)
