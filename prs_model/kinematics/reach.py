"""Saying why a pose is out of reach: the limb, the joint, its value and its limits, in millimetres and degrees."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray, IntArray
from ..description.units import Dimension
from ..errors import UnreachablePoseError
from ..readable import pose_text, readable, readable_range
from .tree import Tree

_LIMIT_SLACK = 1e-9  # m, rad: rounding of a pose that stands exactly at a limit
_TIE = 1e-6  # of a joint's range: joints that are as far beyond their limits, as those of like limbs


@dataclass(frozen=True)
class Reach:
    """Joint limits of a machine and the words for them."""

    tree: Tree
    coordinates: Mapping[str, Dimension]
    symmetry: Mapping[str, tuple[int | str, ...]]

    def beyond_limits(self, pose: FloatArray, q: FloatArray) -> UnreachablePoseError | None:
        """The error for a pose (d,) whose configuration (n,) passes a joint limit; the worst joint is named."""
        j = self._worst(q)
        if j is None:
            return None
        return self._error(pose, f"{self._joint(j)} would stand at {self._stand(q, j)}", q, j)

    def excess(self, q: FloatArray) -> FloatArray:
        """How far joints (..., n) are beyond their limits [m, rad]; zero within."""
        beyond = np.maximum(self.tree.lower - q, q - self.tree.upper)
        return np.where(beyond > _LIMIT_SLACK, beyond, 0.0)

    def worst(self, q: FloatArray) -> IntArray:
        """The joint (...) furthest beyond its limits for its range, of q (..., n) [m, rad]; -1 where none is.

        Of joints that are equally far it is the first, not the one that rounding puts ahead.
        """
        excess = self.excess(q)
        share = excess / np.maximum(self.tree.upper - self.tree.lower, _LIMIT_SLACK)
        is_worst = (excess > 0.0) & (share >= share.max(axis=-1, keepdims=True, initial=0.0) - _TIE)
        numbers = np.where(is_worst, np.arange(q.shape[-1]), q.shape[-1])
        first = numbers.min(axis=-1, initial=q.shape[-1])
        return np.asarray(np.where(first < q.shape[-1], first, -1))

    def no_closed_form(self, pose: FloatArray, q: FloatArray) -> UnreachablePoseError:
        """The error for a pose (d,) at which the closed form finds no value for the joints that are NaN in q (n,)."""
        lacking = np.flatnonzero(np.isnan(q))
        limbs = list(dict.fromkeys(filter(None, (self._limb(self.tree.names[j]) for j in lacking))))
        joints = ", ".join(self.tree.names[j] for j in lacking)
        who = f"{' and '.join(limbs)} cannot reach it: " if limbs else ""
        error = UnreachablePoseError(
            f"pose {self.pose_text(pose)}: {who}no value of {joints} closes the loops",
            pose=self._pose(pose),
            joint=self.tree.names[lacking[0]],
        )
        return error

    def left_open(self, pose: FloatArray, gap: float) -> UnreachablePoseError:
        """The error for a pose (d,) at which the closed form leaves a loop or the pose open by `gap` [m, rad]."""
        return self._error(pose, f"the closed form does not hold there: it leaves a gap of {gap:.3g} (m or rad)")

    def cut_off(self, pose: FloatArray, q: FloatArray, share: float) -> UnreachablePoseError:
        """The error for a pose (d,) towards which the machine follows only so far, to configuration q (n,)."""
        way = f"the loops close only up to {100 * share:.1f} % of the way from the reference pose"
        j = self._worst(q)
        if j is None:
            return self._error(pose, f"{way}; beyond it the pose is out of reach or behind a singular configuration")
        return self._error(pose, f"{way}, where {self._joint(j)} stands at {self._stand(q, j)}", q, j)

    def pose_text(self, pose: FloatArray) -> str:
        """A pose (d,) in words, such as ``nutation=70 deg, z=1275 mm``."""
        return pose_text(self._pose(pose), self.coordinates)

    def joint_text(self, j: int, value: float) -> str:
        """A value of joint j in words."""
        return readable(value, self._dimension(j))

    def _error(
        self, pose: FloatArray, what: str, q: FloatArray | None = None, j: int | None = None
    ) -> UnreachablePoseError:
        message = f"pose {self.pose_text(pose)}: {what}"
        if q is None or j is None:
            return UnreachablePoseError(message, pose=self._pose(pose))
        limits = (float(self.tree.lower[j]), float(self.tree.upper[j]))
        joint = self.tree.names[j]
        return UnreachablePoseError(message, pose=self._pose(pose), joint=joint, value=float(q[j]), limits=limits)

    def _worst(self, q: FloatArray) -> int | None:
        worst = int(self.worst(q))
        return worst if worst >= 0 else None

    def _joint(self, j: int) -> str:
        name = self.tree.names[j]
        limb = self._limb(name)
        return f"joint {name} ({limb})" if limb else f"joint {name}"

    def _stand(self, q: FloatArray, j: int) -> str:
        dimension = self._dimension(j)
        limits = readable_range(self.tree.lower[j], self.tree.upper[j], dimension)
        return f"{readable(q[j], dimension)}, limits {limits}"

    def _dimension(self, j: int) -> Dimension:
        return Dimension(angle=1) if self.tree.revolute[j] else Dimension(length=1)

    def _limb(self, joint: str) -> str | None:
        """``limb 2`` for a joint named ..._2 of a machine with the symmetry ``limb: [1, 2, 3]``."""
        for kind, members in self.symmetry.items():
            for member in members:
                if joint.endswith(f"_{member}"):
                    return f"{kind} {member}"
        return None

    def _pose(self, pose: FloatArray) -> dict[str, float]:
        return dict(zip(self.coordinates, map(float, pose), strict=True))
