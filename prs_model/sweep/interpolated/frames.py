"""What is smooth in the pose though frequencies cross and kink: matrices of the low invariant subspace as a whole.

The span of the lowest p shapes U (n, p) turns smoothly with the pose as long as eigenvalue p + 1 keeps away. Among its
bases that nearest to the home pose's shapes is W = U Q, with Q from the polar decomposition of U^T M U_home. In this
frame the eigenvalues are those of

    L = Q^T log(Lambda - s) Q,

p x p, symmetric and smooth. An error dL moves no log(lambda - s) by more than ||dL|| (Weyl): all frequencies have one
bound of their relative error.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...arrays import FloatArray
from ...synthesis.batch import Systems
from ..low_modes import LowModes


@dataclass(frozen=True, eq=False)
class Frame:
    """The shapes at home (n, p), and the shift s below all eigenvalues [rad^2/s^2]."""

    home: FloatArray
    shift: float

    @property
    def size(self) -> int:
        """Number p of modes that are followed together."""
        return int(self.home.shape[1])


@dataclass(frozen=True, eq=False)
class InFrame:
    """Of N configurations: W (N, n, p), L (N, p, p), and how well the frames fit (N,).

    alignment: the least singular value of U^T M U_home: 1 for the same subspace, 0 where a shape of it is lost.
    """

    frames: FloatArray
    logarithms: FloatArray
    alignment: FloatArray


def in_frame(frame: Frame, systems: Systems, modes: LowModes) -> InFrame:
    """The frame's matrices in every configuration, from at least its p lowest modes."""
    shapes, values = modes.shapes[:, :, : frame.size], modes.eigenvalues[:, : frame.size]
    left, sines, right = np.linalg.svd(shapes.swapaxes(1, 2) @ (systems.mass @ frame.home))
    nearest = left @ right
    logarithms = nearest.swapaxes(1, 2) @ (np.log(values - frame.shift)[:, :, None] * nearest)
    return InFrame(shapes @ nearest, (logarithms + logarithms.swapaxes(1, 2)) / 2.0, sines[:, -1])
