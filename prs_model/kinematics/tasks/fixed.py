"""Structures: parts joined to one that does not move, so that there is no pose to choose."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

import numpy as np

from ...arrays import FloatArray
from ...description.units import Dimension
from .base import Task


class Fixed(Task):
    """No pose coordinate: a frame, a test rig, two parts bolted together."""

    coordinates: ClassVar[Mapping[str, Dimension]] = {}

    def residual(self, R: FloatArray, p: FloatArray, targets: FloatArray) -> FloatArray:
        return np.zeros((len(p), 0))

    def jacobian(self, R: FloatArray, p: FloatArray, J: FloatArray, targets: FloatArray) -> FloatArray:
        return np.zeros((len(p), 0, J.shape[2]))
