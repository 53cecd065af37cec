"""Reduced models held against the complete order of the same assembly, pose by pose."""

from .poses import default_poses, grid_poses, random_poses
from .reductions import REDUCTIONS, Reduction, curve_of, reductions_named, with_joint_stiffness
from .report import Comparison, ModelRun, VerificationReport
from .run import verify

__all__ = [
    "REDUCTIONS",
    "Comparison",
    "ModelRun",
    "Reduction",
    "VerificationReport",
    "curve_of",
    "default_poses",
    "grid_poses",
    "random_poses",
    "reductions_named",
    "verify",
    "with_joint_stiffness",
]
