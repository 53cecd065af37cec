"""Many rigid placements at once, to be used like one of Pinocchio's."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray
from . import kernels


@dataclass(frozen=True, eq=False)
class Placements:
    """Placements of one frame in N configurations, with the names of `pinocchio.SE3`, which they mix with.

    rotation (N, 3, 3), translation (N, 3) [m]. N is 1 for what is the same in all configurations. `carrier`, if given,
    is the body that carries the frame, and `fixed` where on it: frames of one carrier do not move against each other.
    """

    rotation: FloatArray
    translation: FloatArray
    carrier: int | None = None
    fixed: pin.SE3 | None = None

    def __mul__(self, other: pin.SE3) -> Placements:
        """Placements of a frame that stands at `other` in this one."""
        fixed = None if self.fixed is None else self.fixed * other
        return Placements(self.rotation @ other.rotation, self.act(other.translation), self.carrier, fixed)

    def act(self, point: FloatArray) -> FloatArray:
        """Where points (3,) or (N, 3) [m] of this frame are."""
        return np.asarray(self.translation + kernels.transform(self.rotation, point))

    def actInv(self, other: Placements) -> Placements:  # noqa: N802
        """`other` seen from this frame; the same in all configurations if one body carries both."""
        if self.fixed is not None and other.fixed is not None and self.carrier == other.carrier:
            seen = self.fixed.actInv(other.fixed)
            return Placements(seen.rotation[None], seen.translation[None])
        ours, theirs = (self.rotation, self.translation), (other.rotation, other.translation)
        return Placements(*kernels.relative_frame(*ours, *theirs))

    def toActionMatrix(self) -> FloatArray:  # noqa: N802
        """X (N, 6, 6) = [[R, [p]x R], [0, R]], which takes motions to the frame it is seen from."""
        matrix = np.zeros((len(self.rotation), 6, 6))
        matrix[:, :3, :3] = matrix[:, 3:, 3:] = self.rotation
        matrix[:, :3, 3:] = kernels.skew(self.translation) @ self.rotation
        return matrix

    @property
    def homogeneous(self) -> FloatArray:
        """(N, 4, 4)."""
        matrix = np.zeros((len(self.rotation), 4, 4))
        matrix[:, :3, :3], matrix[:, :3, 3], matrix[:, 3, 3] = self.rotation, self.translation, 1.0
        return matrix
