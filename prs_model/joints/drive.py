"""Feed drives: the stiffness along the free axis of an actuated joint."""

from __future__ import annotations

from ..description.schema import BallScrew, ConstantDrive
from ..description.urdf import SLACK
from ..errors import PrsError


def drive_compliance(drive: ConstantDrive | BallScrew, value: float) -> float:
    """Compliance [m/N or rad/(N m)] of a drive when its joint stands at `value` [m or rad].

    Raises PrsError for a drive without stiffness, or a nut beyond its screw.
    """
    if isinstance(drive, BallScrew):
        return ball_screw_compliance(drive, value - drive.origin)
    stiffness = drive.stiffness if drive.stiffness is not None else drive.rotational_stiffness
    if stiffness is None:
        raise PrsError("a constant drive has neither stiffness nor rotational_stiffness")
    return 1.0 / float(stiffness)


def ball_screw_compliance(screw: BallScrew, stroke: float) -> float:
    """A nut in series with a screw held at both ends (footnote of Table 2), stroke [m] from the front bearing.

    1/k = 1/k_nut + 1/(k_1 + k_2), 1/k_1 = 1/k_front + q/EA, 1/k_2 = 1/k_rear + (L - q)/EA.
    Without a rear bearing that end floats, and 1/k = 1/k_nut + 1/k_1.
    Raises PrsError when the nut would stand beyond an end of the screw.
    """
    if not -SLACK <= stroke <= screw.length + SLACK:
        raise PrsError(
            f"the nut would stand {stroke * 1e3:.1f} mm from the front bearing of a screw "
            f"{screw.length * 1e3:.1f} mm long; check the drive's origin and length"
        )
    stroke = min(max(stroke, 0.0), screw.length)
    front = 1.0 / screw.front_bearing + stroke / screw.EA
    if screw.rear_bearing is None:
        return float(1.0 / screw.nut + front)
    rear = 1.0 / screw.rear_bearing + (screw.length - stroke) / screw.EA
    held = 0.0 if front == 0.0 or rear == 0.0 else 1.0 / (1.0 / front + 1.0 / rear)
    return float(1.0 / screw.nut + held)
