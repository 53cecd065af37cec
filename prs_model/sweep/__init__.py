"""Maps of the workspace: frequencies and what comes with them at many poses at once."""

from .poses import Poses, poses_of
from .request import QUANTITIES, Request
from .run import sweep

__all__ = ["QUANTITIES", "Poses", "Request", "poses_of", "sweep"]
