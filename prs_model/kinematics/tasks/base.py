"""What every task provides."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar

from ...arrays import FloatArray
from ...description import schema
from ...description.units import Dimension
from ..tree import Tree


class Task(ABC):
    """Equations that a pose puts on the tool frame, seen from the frame it is measured in (default: the root link).

    Orientation is that of the tool frame relative to the axes it is measured in: all angles are zero where both frames
    are parallel. The tool frame comes as rotations R (N, 3, 3) and positions p (N, 3); its Jacobian J (N, 6, n) holds
    its velocity and angular velocity in the same axes per joint rate.
    """

    coordinates: ClassVar[Mapping[str, Dimension]]
    """Names of the pose coordinates, in order, with their dimensions."""

    Options: ClassVar[type[schema.Section]] = schema.Section
    """Shape of the entry ``task.options``; none by default."""

    def __init__(self, tree: Tree, section: schema.Task, options: schema.Section):
        """`section` is the entry ``task`` of machine.yaml, `options` its validated options in SI."""
        self.tree, self.section, self.options = tree, section, options

    def targets(self, poses: FloatArray) -> FloatArray:
        """What `residual` compares with (N, t), made of poses (N, d); a straight line between two is a usable path."""
        return poses

    @abstractmethod
    def residual(self, R: FloatArray, p: FloatArray, targets: FloatArray) -> FloatArray:
        """How far the tool frame is from its targets (N, d) [m, rad]."""

    @abstractmethod
    def jacobian(self, R: FloatArray, p: FloatArray, J: FloatArray, targets: FloatArray) -> FloatArray:
        """Derivative of `residual` per joint rate (N, d, n)."""

    def closed_form(self, poses: FloatArray) -> FloatArray | None:
        """Joint values (N, n) at poses (N, d), NaN where a joint has none; None if the task knows no closed form."""
        return None
