"""Machines that move in a plane."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from ...arrays import FloatArray
from ...description.units import Dimension
from .base import Task


class Planar(Task):
    """Position (x, y) of the tool frame in the plane z = const of the frame it is measured in, and its angle phi.

    Poses that differ by full turns of phi are the same pose.
    """

    coordinates: ClassVar[Mapping[str, Dimension]] = {
        "x": Dimension(length=1),
        "y": Dimension(length=1),
        "phi": Dimension(angle=1),
    }

    def targets(self, poses: FloatArray) -> FloatArray:
        """(x, y, phi) with phi between -pi and pi."""
        return np.column_stack([poses[:, :2], np.arctan2(np.sin(poses[:, 2]), np.cos(poses[:, 2]))])

    def residual(self, R: FloatArray, p: FloatArray, targets: FloatArray) -> FloatArray:
        turn = np.arctan2(R[:, 1, 0], R[:, 0, 0]) - targets[:, 2]
        return np.column_stack([p[:, :2] - targets[:, :2], np.arctan2(np.sin(turn), np.cos(turn))])

    def jacobian(self, R: FloatArray, p: FloatArray, J: FloatArray, targets: FloatArray) -> FloatArray:
        return J[:, [0, 1, 5]]
