"""Tasks: what a pose of a machine is. Found through the entry-point group ``prs_model.tasks``."""

from .base import Task
from .fixed import Fixed
from .nutation_precession_z import NutationPrecessionZ
from .planar import Planar
from .pose_6dof import Pose6Dof
from .xyz import Xyz

__all__ = ["Fixed", "NutationPrecessionZ", "Planar", "Pose6Dof", "Task", "Xyz"]
