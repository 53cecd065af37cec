"""A local page to explore a machine with, and mode shapes in the viewers of Pinocchio's users."""

from .pinocchio_viewer import ModeMotion, mode_motion, show_mode
from .server import explore

__all__ = ["ModeMotion", "explore", "mode_motion", "show_mode"]
