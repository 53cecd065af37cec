"""What is smooth in the pose though frequencies cross and kink: matrices of the low invariant subspace as a whole.

The span of the lowest p shapes U (n, p) turns smoothly with the pose as long as eigenvalue p + 1 keeps away. Among its
bases that nearest to the home pose's shapes is W = U Q, with Q from the polar decomposition of U^T M U_home. In this
frame the eigenvalues are those of

    L = Q^T log(Lambda - s) Q,

p x p, symmetric and smooth. An error dL moves no log(lambda - s) by more than ||dL|| (Weyl): all frequencies have one
bound of their relative error.

How many eigenvalues lie below a level l does not depend on that choice. For any shapes V, fixed in the bodies' axes,

    [[K - l M, M V], [V^T M, 0]]^-1 = [[.., ..], [.., -Z]],

the Schur complement Z of K - l M on V has as many negative eigenvalues as K - l M when the rest, on the shapes that are
M-orthogonal to V, is positive definite (Haynsworth, Linear Algebra Appl. 1, 1968). Z is smooth in the pose where
frequencies cross the level too; only an eigenvalue of the rest at the level would give it a pole.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from ..synthesis.batch import Systems
from .low_modes import LowModes


@dataclass(frozen=True, eq=False)
class Frame:
    """The shapes at home (n, p), the shift s below all eigenvalues and the level l above the p lowest [rad^2/s^2].

    level: None where the machine has no more than p modes, and nothing can be missed.
    """

    home: FloatArray
    shift: float
    level: float | None

    @property
    def size(self) -> int:
        """Number p of modes that are followed together."""
        return int(self.home.shape[1])


@dataclass(frozen=True, eq=False)
class InFrame:
    """Of N configurations: W (N, n, p), L (N, p, p), Z (N, p, p) or none, and how well the frames fit (N,).

    alignment: the least singular value of U^T M U_home: 1 for the same subspace, 0 where a shape of it is lost.
    """

    frames: FloatArray
    logarithms: FloatArray
    complements: FloatArray | None
    alignment: FloatArray


def in_frame(frame: Frame, systems: Systems, modes: LowModes) -> InFrame:
    """The frame's matrices in every configuration, from at least its p lowest modes."""
    shapes, values = modes.shapes[:, :, : frame.size], modes.eigenvalues[:, : frame.size]
    left, sines, right = np.linalg.svd(shapes.swapaxes(1, 2) @ (systems.mass @ frame.home))
    nearest = left @ right
    logarithms = nearest.swapaxes(1, 2) @ (np.log(values - frame.shift)[:, :, None] * nearest)
    complement = None if frame.level is None else complements(frame.home, frame.level, systems)
    return InFrame(shapes @ nearest, (logarithms + logarithms.swapaxes(1, 2)) / 2.0, complement, sines[:, -1])


def complements(shapes: FloatArray, level: float, systems: Systems) -> FloatArray:
    """Z (N, p, p) of shapes V (n, p) at a level [rad^2/s^2]."""
    momenta, p = systems.mass @ shapes, shapes.shape[1]
    result = np.empty((len(momenta), p, p))
    for i, (mass, stiffness, free) in enumerate(systems.pencils):
        bordered = np.zeros((len(mass) + p, len(mass) + p))
        bordered[:-p, :-p] = stiffness - level * mass
        bordered[:-p, -p:] = free.T @ momenta[i]
        bordered[-p:, :-p] = bordered[:-p, -p:].T
        scale = 1.0 / np.sqrt(np.maximum(np.abs(bordered).max(axis=0), np.finfo(float).tiny))
        unit = np.zeros((len(bordered), p))
        unit[-p:] = np.diag(scale[-p:])
        solved = scale[-p:, None] * np.linalg.solve(bordered * np.outer(scale, scale), unit)[-p:]
        result[i] = -(solved + solved.T) / 2.0
    return result
