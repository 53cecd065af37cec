"""Kinematics of closed mechanisms: from a pose to joint values and the placement of every link."""

from .configuration import Configuration, Configurations
from .kinematics import Kinematics
from .placements import Placements

__all__ = ["Configuration", "Configurations", "Kinematics", "Placements"]
