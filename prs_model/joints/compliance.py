"""The algebra of elastic joints: the wrenches a joint transmits and the compliance on them.

A joint relates the relative displacement d (6,) of two coinciding points to the wrench f (6,) between them,
both linear part first. It transmits the wrenches f = W phi only, and W^T d = C phi. Directions outside W are
free; directions in the null space of C are rigid; neither needs a penalty. Moving a joint to another frame
changes W alone.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import BoolArray, FloatArray
from ..errors import PrsError

_RANK_TOLERANCE = 1e-10
_CLEARLY = 1e-4  # how much of a row is new, at least, where rows are clearly independent
_ROUND_OFF = 1e-14


@dataclass(frozen=True, eq=False)
class JointCompliance:
    """Constraint-wrench basis W (6, m) [N, N m per unit] and compliance C (m, m) on it [m/N, rad/(N m)].

    Either may be a stack (N, ...) for as many configurations, whose joints have equally many free and rigid directions.
    """

    wrenches: FloatArray
    compliance: FloatArray

    def moved(self, action: FloatArray) -> JointCompliance:
        """The joint seen from another frame; `action` (6, 6) takes displacements there (X in eq. 11-14)."""
        return JointCompliance(_moved_wrenches(action, self.wrenches), self.compliance)

    def scaled(self, factor: float) -> JointCompliance:
        """The joint with `factor` times the stiffness; what is rigid or free stays so."""
        return JointCompliance(self.wrenches, self.compliance / factor)

    @cached_property
    def free_twists(self) -> FloatArray:
        """Basis (6, 6 - m) of the relative displacements that meet no resistance."""
        return null_space(_transposed(self.wrenches))

    @cached_property
    def reciprocal(self) -> FloatArray:
        """W^+ (m, 6), which takes a transmitted wrench to its components."""
        return np.asarray(np.linalg.pinv(self.wrenches))

    @cached_property
    def stiffness(self) -> FloatArray:
        """K = W C^+ W^T (6, 6): the elastic directions, zero along free and rigid ones."""
        inverse, _ = self._halves
        return np.asarray(self.wrenches @ inverse @ _transposed(self.wrenches))

    @cached_property
    def rigid_wrenches(self) -> FloatArray:
        """Wrenches (6, r) whose directions are rigid: rigid_wrenches^T d = 0."""
        _, rigid = self._halves
        return np.asarray(self.wrenches @ rigid)

    @cached_property
    def _halves(self) -> tuple[FloatArray, FloatArray]:
        return elastic_and_rigid(self.compliance)


def along_axes(compliances: Mapping[int, ArrayLike]) -> JointCompliance:
    """A joint with one compliance, () or (N,), per coordinate axis 0..5; axes left out are free, zero is rigid."""
    axes = sorted(compliances)
    values = np.stack(np.broadcast_arrays(*(compliances[axis] for axis in axes)), axis=-1) if axes else np.zeros(0)
    return JointCompliance(np.eye(6)[:, axes], values[..., None] * np.eye(len(axes)))


def from_stiffness_matrix(stiffness: FloatArray) -> JointCompliance:
    """A joint from a symmetric positive semi-definite K (6, 6); the null space of K is free."""
    scale = _unit_scale(stiffness)
    wrenches = column_space(stiffness * np.outer(scale, scale)) / scale[:, None]
    reciprocal = np.linalg.pinv(wrenches)
    return JointCompliance(wrenches, np.linalg.inv(reciprocal @ stiffness @ reciprocal.T))


def parallel(joints: Sequence[JointCompliance]) -> JointCompliance:
    """Joints between the same two points, in one frame (eq. 11; rigid directions allowed).

    The wrench W phi divides among the joints so that the complementary energy is least.
    """
    if len(joints) == 1:
        return joints[0]
    basis = np.concatenate([joint.wrenches for joint in joints], axis=-1)
    compliance = _block_diagonal([joint.compliance for joint in joints])
    wrenches = column_space(basis)
    share = np.linalg.pinv(basis) @ wrenches
    internal = null_space(basis)
    inverse, _ = elastic_and_rigid(_transposed(internal) @ compliance @ internal)
    share = share - internal @ (inverse @ (_transposed(internal) @ compliance @ share))
    return JointCompliance(wrenches, np.asarray(_transposed(share) @ compliance @ share))


def series(joints: Sequence[JointCompliance], actions: Sequence[FloatArray]) -> JointCompliance:
    """Joints one after the other: compliances add on the wrenches that all of them transmit.

    Each joint is given in its own frame, with the action (6, 6) that takes its displacements to the common frame.
    The sound form of eq. (12) and (14): K = W (W^T C W)^-1 W^T with W = null(F^T), F all free twists.
    """
    free = [action @ joint.free_twists for joint, action in zip(joints, actions, strict=True)]
    wrenches = null_space(_transposed(_side_by_side(free)))
    shares = [
        joint.reciprocal @ (_transposed(action) @ wrenches) for joint, action in zip(joints, actions, strict=True)
    ]
    compliance = sum(_transposed(share) @ joint.compliance @ share for share, joint in zip(shares, joints, strict=True))
    return JointCompliance(wrenches, np.asarray(compliance))


def series_as_printed(joints: Sequence[JointCompliance], actions: Sequence[FloatArray]) -> JointCompliance:
    """Eq. (14) to the letter: 6x6 compliances, zero on each stage's own free axis, added and inverted.

    Each joint is given in its own frame, with the action (6, 6) that takes its displacements to the common frame.
    A free axis counts as having no compliance, so that the other stages resist it.
    """
    total = np.zeros((6, 6))
    for joint, action in zip(joints, actions, strict=True):
        arrived = action @ _transposed(joint.reciprocal)
        total = total + arrived @ joint.compliance @ _transposed(arrived)
    return JointCompliance(np.eye(6), total)


def elastic_and_rigid(compliance: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Generalised inverse of a positive semi-definite C (m, m), and a basis (m, r) of its null space; or of a stack.

    The rank is decided on C scaled to a unit diagonal, so that metres and radians do not matter; a diagonal
    entry that is round-off beside the largest one is zero. Raises PrsError when it differs within a stack.
    """
    if not compliance.any():
        size = compliance.shape[-1]
        return np.zeros((size, size)), np.eye(size)
    scale = _unit_scale(compliance)
    values, vectors = np.linalg.eigh(compliance * scale[..., :, None] * scale[..., None, :])
    largest = values.max(axis=-1, initial=0.0, keepdims=True)
    count = _rank(values > _RANK_TOLERANCE * np.maximum(1.0, largest))
    vectors = vectors * scale[..., :, None]
    rigid, elastic = np.split(vectors, [values.shape[-1] - count], axis=-1)
    inverse = (elastic / values[..., None, values.shape[-1] - count :]) @ _transposed(elastic)
    return np.asarray(inverse), rigid


def null_space(matrix: FloatArray) -> FloatArray:
    """Orthonormal basis (n, n - rank) of the null space of a matrix (m, n), or of a stack of them.

    Rows that are clearly independent need no singular values; what is orthogonal to them is found faster without.
    """
    if matrix.shape[-2] < matrix.shape[-1]:
        full, triangle = np.linalg.qr(_transposed(matrix), mode="complete")
        sizes = np.abs(np.diagonal(triangle, axis1=-2, axis2=-1))
        if np.all(sizes > _CLEARLY * sizes.max(axis=-1, initial=0.0, keepdims=True)):
            return np.asarray(full[..., matrix.shape[-2] :])
    _, values, right = np.linalg.svd(matrix)
    return np.asarray(_transposed(right[..., _rank(_present(values)) :, :]))


def column_space(matrix: FloatArray) -> FloatArray:
    """Orthonormal basis (m, rank) of the columns of a matrix (m, n), or of a stack of them."""
    left, values, _ = np.linalg.svd(matrix, full_matrices=False)
    return np.asarray(left[..., : _rank(_present(values))])


def _present(singular: FloatArray) -> BoolArray:
    return np.asarray(singular > _RANK_TOLERANCE * singular.max(axis=-1, initial=0.0, keepdims=True))


def _rank(present: BoolArray) -> int:
    """How many directions are present, which must be as many in all of a stack."""
    counts = present.sum(axis=-1)
    if np.ptp(counts) > 0:
        raise PrsError(
            f"a joint leaves different numbers of directions free or rigid ({counts.min()} and {counts.max()}) at "
            "poses that are assembled together; assemble them one by one"
        )
    return int(counts.max())


def _unit_scale(matrix: FloatArray) -> FloatArray:
    diagonal = np.diagonal(matrix, axis1=-2, axis2=-1)
    present = diagonal > _ROUND_OFF * diagonal.max(axis=-1, initial=0.0, keepdims=True)
    return np.asarray(1.0 / np.sqrt(np.where(present, diagonal, 1.0)))


def _moved_wrenches(action: FloatArray, wrenches: FloatArray) -> FloatArray:
    """X^-T W: forces move as angular displacements do, moments as linear ones."""
    return np.asarray(np.roll(action @ np.roll(wrenches, 3, axis=-2), 3, axis=-2))


def _side_by_side(matrices: Sequence[FloatArray]) -> FloatArray:
    shape = np.broadcast_shapes(*(matrix.shape[:-2] for matrix in matrices))
    return np.concatenate([np.broadcast_to(matrix, shape + matrix.shape[-2:]) for matrix in matrices], axis=-1)


def _block_diagonal(matrices: Sequence[FloatArray]) -> FloatArray:
    stops = np.cumsum([matrix.shape[-1] for matrix in matrices])
    whole = np.zeros((*np.broadcast_shapes(*(matrix.shape[:-2] for matrix in matrices)), stops[-1], stops[-1]))
    for matrix, stop in zip(matrices, stops, strict=True):
        own = slice(stop - matrix.shape[-1], stop)
        whole[..., own, own] = matrix
    return whole


def _transposed(matrix: FloatArray) -> FloatArray:
    return np.swapaxes(matrix, -1, -2)
