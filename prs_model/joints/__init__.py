"""Elastic joints: constraint wrenches, compliances in parallel and in series, feed drives."""

from .compliance import JointCompliance, along_axes, from_stiffness_matrix, parallel, series, series_as_printed
from .drive import ball_screw_compliance, drive_compliance
from .springs import ElasticJoint, Spring, elastic_joints, elastic_law

__all__ = [
    "ElasticJoint",
    "JointCompliance",
    "Spring",
    "along_axes",
    "ball_screw_compliance",
    "drive_compliance",
    "elastic_joints",
    "elastic_law",
    "from_stiffness_matrix",
    "parallel",
    "series",
    "series_as_printed",
]
