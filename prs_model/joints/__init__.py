"""Elastic joints: constraint wrenches, compliances in parallel and in series, feed drives."""

from .compliance import JointCompliance, along_axes, from_stiffness_matrix, parallel, series, series_as_printed
from .drive import ball_screw_compliance, drive_compliance
from .springs import Spring, springs

__all__ = [
    "JointCompliance",
    "Spring",
    "along_axes",
    "ball_screw_compliance",
    "drive_compliance",
    "from_stiffness_matrix",
    "parallel",
    "series",
    "series_as_printed",
    "springs",
]
