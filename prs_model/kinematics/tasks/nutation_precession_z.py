"""Heads of one translation and two rotations (1T2R)."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from ...arrays import FloatArray
from ...description.units import Dimension
from .. import kernels
from .base import Task


class NutationPrecessionZ(Task):
    """Tilt of the tool axis by `nutation` theta towards `precession` psi, and height z of the tool frame.

    Without torsion R = Rz(psi) Ry(theta) Rz(-psi) = exp(theta [-sin psi, cos psi, 0]). The x and y components of R's
    rotation vector are prescribed, which is regular at nutation zero; its z component is left to the machine.
    Poses that differ by full turns of theta or psi are the same pose.
    """

    coordinates: ClassVar[Mapping[str, Dimension]] = {
        "nutation": Dimension(angle=1),
        "precession": Dimension(angle=1),
        "z": Dimension(length=1),
    }

    def targets(self, poses: FloatArray) -> FloatArray:
        """Rotation-vector components and height (theta_x, theta_y, z), (N, 3), with theta between -pi and pi."""
        nutation, precession, z = poses.T
        tilt = np.arctan2(np.sin(nutation), np.cos(nutation))
        return np.column_stack([-tilt * np.sin(precession), tilt * np.cos(precession), z])

    def residual(self, R: FloatArray, p: FloatArray, targets: FloatArray) -> FloatArray:
        return np.column_stack([kernels.rotation_vector(R)[:, :2], p[:, 2]]) - targets

    def jacobian(self, R: FloatArray, p: FloatArray, J: FloatArray, targets: FloatArray) -> FloatArray:
        turning = kernels.inverse_left_jacobian(kernels.rotation_vector(R))[:, :2] @ J[:, 3:]
        return np.concatenate([turning, J[:, 2:3]], axis=1)
