"""Mass, centre and inertia of a part from its mass matrix in rigid motion."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from .rigid_motion import cross_matrix


@dataclass(frozen=True, eq=False)
class MassProperties:
    """mass [kg], centre (3,) [m] and inertia (3, 3) about the centre [kg m^2], in body axes."""

    mass: float
    centre: FloatArray
    inertia: FloatArray

    def rigid_mass(self) -> FloatArray:
        """(6, 6) mass matrix of the rigid part about the body origin: the inverse of `mass_properties`."""
        arm = cross_matrix(self.centre)
        rigid = np.zeros((6, 6))
        rigid[:3, :3] = self.mass * np.eye(3)
        rigid[3:, :3], rigid[:3, 3:] = self.mass * arm, -self.mass * arm
        rigid[3:, 3:] = self.inertia - self.mass * arm @ arm
        return rigid


def excess_moment(inertia: FloatArray) -> float:
    """By how much [kg m^2] a (3, 3) inertia misses that of a body, whose moments each are at most the others' sum."""
    moments = np.linalg.eigvalsh(inertia)
    return float(max(0.0, -moments[0], moments[2] - moments[0] - moments[1]))


def mass_properties(rigid_mass: FloatArray) -> MassProperties:
    """Read M_rb = phi^T M phi = [[m, -m [c]x], [m [c]x, J_0]], phi the unit rigid motions about the body origin."""
    mass = float(np.trace(rigid_mass[:3, :3])) / 3.0
    moment = (rigid_mass[3:, :3] - rigid_mass[3:, :3].T) / 2.0
    first = np.array([moment[2, 1], moment[0, 2], moment[1, 0]])
    centre = first / mass if mass > 0.0 else np.zeros(3)
    arm = cross_matrix(centre)
    inertia = (rigid_mass[3:, 3:] + rigid_mass[3:, 3:].T) / 2.0 + mass * arm @ arm
    return MassProperties(mass, centre, inertia)
