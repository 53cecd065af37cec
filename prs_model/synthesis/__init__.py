"""Substructure synthesis: bodies and joints become one labelled system."""

from .assembly import assemble, wide_joints
from .batch import Systems, assemble_many
from .system import Coordinate, SpringMotion, System

__all__ = ["Coordinate", "SpringMotion", "System", "Systems", "assemble", "assemble_many", "wide_joints"]
