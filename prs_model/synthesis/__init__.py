"""Substructure synthesis: bodies and joints become one labelled system."""

from .assembly import assemble, wide_joints
from .batch import Systems, assemble_many
from .dual import DualSystems, dual_assembly
from .system import Coordinate, SpringMotion, System

__all__ = [
    "Coordinate",
    "DualSystems",
    "SpringMotion",
    "System",
    "Systems",
    "assemble",
    "assemble_many",
    "dual_assembly",
    "wide_joints",
]
