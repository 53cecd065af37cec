"""Machines that place their tool frame freely."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from ...arrays import FloatArray
from ...description.units import Dimension
from .. import kernels
from .base import Task


class Pose6Dof(Task):
    """Position (x, y, z) of the tool frame and its rotation vector (rx, ry, rz)."""

    coordinates: ClassVar[Mapping[str, Dimension]] = {
        **{name: Dimension(length=1) for name in ("x", "y", "z")},
        **{name: Dimension(angle=1) for name in ("rx", "ry", "rz")},
    }

    def residual(self, R: FloatArray, p: FloatArray, targets: FloatArray) -> FloatArray:
        return np.concatenate([p - targets[:, :3], _error(R, targets)], axis=1)

    def jacobian(self, R: FloatArray, p: FloatArray, J: FloatArray, targets: FloatArray) -> FloatArray:
        turning = kernels.inverse_left_jacobian(_error(R, targets)) @ J[:, 3:]
        return np.concatenate([J[:, :3], turning], axis=1)


def _error(R: FloatArray, targets: FloatArray) -> FloatArray:
    """Rotation vector (N, 3) of R R_target^T: small near the target wherever that is."""
    return kernels.rotation_vector(R @ np.swapaxes(kernels.rotation(targets[:, 3:]), -1, -2))
