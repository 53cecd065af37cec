"""Two ways to tie an interface's finite-element nodes to one condensation node of six coordinates."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations, permutations

import numpy as np
from scipy.sparse import csr_array

from ..arrays import FloatArray, IntArray
from ..description.interface import Coupling
from ..errors import PartFileError
from ..finite_elements import FiniteElementModel


@dataclass(frozen=True, eq=False)
class Tie:
    """Finite-element nodes `indices` (m,), weighted (m,), that act through the condensation node at `position` [m]."""

    node: str
    indices: IntArray
    weights: FloatArray
    position: FloatArray
    coupling: Coupling


def rigid_rows(model: FiniteElementModel, tie: Tie) -> tuple[IntArray, FloatArray]:
    """Rigid multipoint constraint, eq. (4)-(6): rows b (m,) of the model and T (m, 6) with ``u_b = T U``."""
    rows = model.rows_of(tie.indices)
    return rows, model.rigid_body_modes(rows, about=tie.position)


def averaging_matrix(model: FiniteElementModel, tie: Tie) -> csr_array:
    """Distributing coupling: D (6, n) with ``U = D u``, the rigid motion that fits the nodes best.

    U minimises sum_i w_i |u_i - X_i U|^2 over the nodes' translations, so D = (X^T W X)^-1 X^T W and D X = 1: the
    interface stays as flexible as the part makes it, and a load on U spreads over the nodes by their weights.
    """
    rows = model.rows[tie.indices, :3]
    weights = np.repeat(tie.weights, 3)[rows.ravel() >= 0]
    rows = rows[rows >= 0]
    motions = model.rigid_body_modes(rows, about=tie.position)
    weighted = motions * (weights / weights.sum())[:, None]
    averaging = np.linalg.solve(motions.T @ weighted, weighted.T)
    place = np.tile(rows, 6)
    return csr_array((averaging.ravel(), (np.repeat(np.arange(6), len(rows)), place)), shape=(6, model.size))


def rigidified(model: FiniteElementModel, tie: Tie) -> tuple[FiniteElementModel, csr_array]:
    """The model with a rigid tie's nodes replaced by one of six DOFs, its last rows; and P (n, n'), u = P u'."""
    rows, block = rigid_rows(model, tie)
    kept = np.setdiff1d(np.arange(model.size), rows)
    new = len(kept) + np.arange(6)
    entries = np.concatenate([np.ones(len(kept)), block.ravel()])
    into = np.concatenate([kept, np.repeat(rows, 6)])
    outof = np.concatenate([np.arange(len(kept)), np.tile(new, len(rows))])
    projection = csr_array((entries, (into, outof)), shape=(model.size, len(kept) + 6))
    node = np.column_stack([np.full(6, len(model.coordinates)), np.arange(6)])
    smaller = replace(
        model,
        stiffness=csr_array(projection.T @ model.stiffness @ projection),
        mass=csr_array(projection.T @ model.mass @ projection),
        coordinates=np.vstack([model.coordinates, tie.position]),
        node_ids=None,
        areas=None,
        dofs=np.vstack([model.dofs[kept], node]),
    )
    return smaller, projection


def check_ties(model: FiniteElementModel, ties: Sequence[Tie]) -> None:
    """Raises PartFileError when a tie's nodes lie on a line (or point), or two rigid ties share nodes."""
    for tie in ties:
        if not _holds_six_motions(model, tie):
            raise PartFileError(
                model.source,
                f"interface {tie.node}: its {len(tie.indices)} nodes lie on one line and cannot take up a rotation "
                "about it; select nodes of a surface",
            )
    for one, other in combinations([tie for tie in ties if tie.coupling == "rigid"], 2):
        shared = np.intersect1d(one.indices, other.indices)
        if len(shared):
            first = ", ".join(f"{x:.4g}" for x in model.coordinates[shared[0]])
            raise PartFileError(
                model.source,
                f"interfaces {one.node} and {other.node} share {len(shared)} nodes, the first at ({first}) m, which "
                "cannot follow two rigid nodes at once; make the selections apart, or tie one of them with "
                "'coupling: averaged'",
            )
    for averaged, other in permutations(ties, 2):
        if averaged.coupling == "averaged" and _follows(averaged, other):
            raise PartFileError(
                model.source,
                f"interface {averaged.node} is averaged over nodes that {other.node} moves already, so it repeats "
                f"{other.node}; use one interface for both, or select other nodes",
            )


def _follows(averaged: Tie, other: Tie) -> bool:
    """Whether the motion of an averaged node is fixed by another's: nodes inside a rigid tie, or the same average."""
    if other.coupling == "rigid":
        return bool(np.all(np.isin(averaged.indices[averaged.weights != 0.0], other.indices)))
    (a, b), (one, two) = (averaged.indices, other.indices), (averaged.weights, other.weights)
    return np.array_equal(a, b) and np.allclose(one / one.sum(), two / two.sum())


def _holds_six_motions(model: FiniteElementModel, tie: Tie) -> bool:
    """Whether the mean of X^T W X, in the tie's own length, is positive definite; W = 1 of a rigid one."""
    averaged = tie.coupling == "averaged"
    rows = model.rows[tie.indices, : 3 if averaged else 6]
    weights = np.broadcast_to((tie.weights if averaged else np.ones(len(rows)))[:, None], rows.shape)[rows >= 0]
    rows = rows[rows >= 0]
    centre = model.coordinates[tie.indices].mean(axis=0)
    size = float(np.linalg.norm(model.coordinates[tie.indices] - centre, axis=1).max())
    scale = np.array([1.0, 1.0, 1.0, *(3 * [1.0 / size if size > 0.0 else 1.0])])
    motions = model.rigid_body_modes(rows, about=centre) * scale
    mean = motions.T @ (motions * weights[:, None]) / weights.sum()
    return len(rows) >= 6 and float(np.linalg.eigvalsh(mean)[0]) > 1e-12
