"""Joint-loaded Craig-Bampton: parts in the few shapes that their joints can give them."""

from .parts import joint_loaded_parts

__all__ = ["joint_loaded_parts"]
