"""The algebra of elastic joints: the wrenches a joint transmits and the compliance on them.

A joint relates the relative displacement d (6,) of two coinciding points to the wrench f (6,) between them,
both linear part first. It transmits the wrenches f = W phi only, and W^T d = C phi. Directions outside W are
free; directions in the null space of C are rigid; neither needs a penalty. Moving a joint to another frame
changes W alone.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag, null_space, orth

from ..arrays import FloatArray

_RANK_TOLERANCE = 1e-10
_ROUND_OFF = 1e-14


@dataclass(frozen=True, eq=False)
class JointCompliance:
    """Constraint-wrench basis W (6, m) [N, N m per unit] and compliance C (m, m) on it [m/N, rad/(N m)]."""

    wrenches: FloatArray
    compliance: FloatArray

    def moved(self, action: FloatArray) -> JointCompliance:
        """The joint seen from another frame; `action` (6, 6) takes displacements there (X in eq. 11-14)."""
        return JointCompliance(np.asarray(np.linalg.solve(action.T, self.wrenches)), self.compliance)

    def scaled(self, factor: float) -> JointCompliance:
        """The joint with `factor` times the stiffness; what is rigid or free stays so."""
        return JointCompliance(self.wrenches, self.compliance / factor)

    @property
    def free_twists(self) -> FloatArray:
        """Basis (6, 6 - m) of the relative displacements that meet no resistance."""
        return _null_space(self.wrenches.T)

    @cached_property
    def stiffness(self) -> FloatArray:
        """K = W C^+ W^T (6, 6): the elastic directions, zero along free and rigid ones."""
        inverse, _ = self._halves
        return self.wrenches @ inverse @ self.wrenches.T

    @cached_property
    def rigid_wrenches(self) -> FloatArray:
        """Wrenches (6, r) whose directions are rigid: rigid_wrenches^T d = 0."""
        _, rigid = self._halves
        return self.wrenches @ rigid

    @cached_property
    def _halves(self) -> tuple[FloatArray, FloatArray]:
        return elastic_and_rigid(self.compliance)


def along_axes(compliances: dict[int, float]) -> JointCompliance:
    """A joint with one compliance per coordinate axis 0..5; axes left out are free, zero is rigid."""
    axes = sorted(compliances)
    return JointCompliance(np.eye(6)[:, axes], np.diag([compliances[axis] for axis in axes]))


def from_stiffness_matrix(stiffness: FloatArray) -> JointCompliance:
    """A joint from a symmetric positive semi-definite K (6, 6); the null space of K is free."""
    scale = _unit_scale(stiffness)
    wrenches = orth(stiffness * np.outer(scale, scale), rcond=_RANK_TOLERANCE) / scale[:, None]
    reciprocal = np.linalg.pinv(wrenches)
    return JointCompliance(wrenches, np.linalg.inv(reciprocal @ stiffness @ reciprocal.T))


def parallel(joints: Sequence[JointCompliance]) -> JointCompliance:
    """Joints between the same two points, in one frame (eq. 11; rigid directions allowed).

    The wrench W phi divides among the joints so that the complementary energy is least.
    """
    if len(joints) == 1:
        return joints[0]
    basis = np.hstack([joint.wrenches for joint in joints])
    compliance = block_diag(*[joint.compliance for joint in joints])
    wrenches = orth(basis, rcond=_RANK_TOLERANCE)
    share = np.linalg.pinv(basis) @ wrenches
    internal = _null_space(basis)
    inverse, _ = elastic_and_rigid(internal.T @ compliance @ internal)
    share = share - internal @ (inverse @ (internal.T @ compliance @ share))
    return JointCompliance(wrenches, share.T @ compliance @ share)


def series(joints: Sequence[JointCompliance]) -> JointCompliance:
    """Joints one after the other, in one frame: compliances add on the wrenches that all of them transmit.

    The sound form of eq. (12) and (14): K = W (W^T C W)^-1 W^T with W = null(F^T), F all free twists.
    """
    if len(joints) == 1:
        return joints[0]
    free = np.hstack([joint.free_twists for joint in joints])
    wrenches = _null_space(free.T) if free.shape[1] else np.eye(6)
    shares = [np.linalg.pinv(joint.wrenches) @ wrenches for joint in joints]
    compliance = sum(share.T @ joint.compliance @ share for share, joint in zip(shares, joints, strict=True))
    return JointCompliance(wrenches, np.asarray(compliance))


def series_as_printed(joints: Sequence[JointCompliance], actions: Sequence[FloatArray]) -> JointCompliance:
    """Eq. (14) to the letter: 6x6 compliances, zero on each stage's own free axis, added and inverted.

    Each joint is given in its own frame, with the action (6, 6) that takes its displacements to the common frame.
    A free axis counts as having no compliance, so that the other stages resist it.
    """
    total = np.zeros((6, 6))
    for joint, action in zip(joints, actions, strict=True):
        reciprocal = np.linalg.pinv(joint.wrenches)
        total += action @ reciprocal.T @ joint.compliance @ reciprocal @ action.T
    return JointCompliance(np.eye(6), total)


def elastic_and_rigid(compliance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Generalised inverse of a positive semi-definite C (m, m), and a basis (m, r) of its null space.

    The rank is decided on C scaled to a unit diagonal, so that metres and radians do not matter; a diagonal
    entry that is round-off beside the largest one is zero.
    """
    scale = _unit_scale(compliance)
    values, vectors = np.linalg.eigh(compliance * np.outer(scale, scale))
    stiff = values <= _RANK_TOLERANCE * max(1.0, values.max(initial=0.0))
    elastic = vectors[:, ~stiff] * scale[:, None]
    inverse = elastic @ np.diag(1.0 / values[~stiff]) @ elastic.T
    return inverse, vectors[:, stiff] * scale[:, None]


def _unit_scale(matrix: FloatArray) -> FloatArray:
    diagonal = np.diag(matrix)
    present = diagonal > _ROUND_OFF * diagonal.max(initial=0.0)
    return 1.0 / np.sqrt(np.where(present, diagonal, 1.0))


def _null_space(matrix: FloatArray) -> FloatArray:
    return np.asarray(null_space(matrix, rcond=_RANK_TOLERANCE))
