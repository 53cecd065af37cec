"""Machines that only translate, or whose rotations follow from the position."""

from __future__ import annotations

from collections.abc import Mapping
from typing import ClassVar

from ...arrays import FloatArray
from ...description.units import Dimension
from .base import Task


class Xyz(Task):
    """Position (x, y, z) of the tool frame."""

    coordinates: ClassVar[Mapping[str, Dimension]] = {name: Dimension(length=1) for name in ("x", "y", "z")}

    def residual(self, R: FloatArray, p: FloatArray, targets: FloatArray) -> FloatArray:
        return p - targets

    def jacobian(self, R: FloatArray, p: FloatArray, J: FloatArray, targets: FloatArray) -> FloatArray:
        return J[:, :3]
