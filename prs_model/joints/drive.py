"""Feed drives: the stiffness along the free axis of an actuated joint."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import FloatArray
from ..description.schema import BallScrew, ConstantDrive
from ..description.urdf import SLACK
from ..errors import PrsError


def drive_compliance(drive: ConstantDrive | BallScrew, value: ArrayLike) -> FloatArray:
    """Compliance [m/N or rad/(N m)] of a drive when its joint stands at `value` [m or rad], or for each of many values.

    One compliance for all values where the drive is constant.

    Raises PrsError for a drive without stiffness, or a nut beyond its screw.
    """
    if isinstance(drive, BallScrew):
        return ball_screw_compliance(drive, np.asarray(value) - drive.origin)
    stiffness = drive.stiffness if drive.stiffness is not None else drive.rotational_stiffness
    if stiffness is None:
        raise PrsError("a constant drive has neither stiffness nor rotational_stiffness")
    return np.array(1.0 / float(stiffness))


def ball_screw_compliance(screw: BallScrew, stroke: ArrayLike) -> FloatArray:
    """A nut in series with a screw held at both ends (footnote of Table 2), strokes [m] from the front bearing.

    1/k = 1/k_nut + 1/(k_1 + k_2), 1/k_1 = 1/k_front + q/EA, 1/k_2 = 1/k_rear + (L - q)/EA.
    Without a rear bearing that end floats, and 1/k = 1/k_nut + 1/k_1.
    Raises PrsError when the nut would stand beyond an end of the screw.
    """
    asked, length = np.asarray(stroke, dtype=float), float(screw.length)
    beyond = ~((asked >= -SLACK) & (asked <= length + SLACK))
    if beyond.any():
        raise PrsError(
            f"the nut would stand {asked[beyond][0] * 1e3:.1f} mm from the front bearing of a screw "
            f"{length * 1e3:.1f} mm long; check the drive's origin and length"
        )
    q = np.clip(asked, 0.0, length)
    front = 1.0 / screw.front_bearing + q / screw.EA
    if screw.rear_bearing is None:
        return np.asarray(1.0 / screw.nut + front)
    rear = 1.0 / screw.rear_bearing + (length - q) / screw.EA
    both = np.where(front + rear > 0.0, front + rear, 1.0)
    return np.asarray(1.0 / screw.nut + front * rear / both)
