"""Substructure synthesis: bodies and joints become one labelled system."""

from .assembly import assemble, wide_joints
from .system import Coordinate, SpringMotion, System

__all__ = ["Coordinate", "SpringMotion", "System", "assemble", "wide_joints"]
