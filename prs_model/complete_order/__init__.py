"""The complete-order model: every part with all its DOFs, joined by the same joints, at any pose."""

from .model import CompleteModes, CompleteOrder

__all__ = ["CompleteModes", "CompleteOrder"]
