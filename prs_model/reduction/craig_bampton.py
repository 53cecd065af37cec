"""Craig-Bampton reduction with the boundary projected first: eq. (4)-(8) in the order that costs least.

Rigid ties enter by projection, u_b = T U, before anything is factorized; averaged ties as constraints D u = U. Both
give exact statics of the tied part, and the fixed-interface modes of the part with all condensation nodes held.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import eigh
from scipy.sparse import csr_array, vstack
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

from ..errors import PartFileError, PhysicsError
from ..finite_elements import FiniteElementModel
from .constrained import ConstrainedSolve, constrained_solver
from .coupling import Tie, averaging_matrix, check_ties, rigid_rows

FloatArray = NDArray[np.float64]
IntArray = NDArray[np.int64]


@dataclass(frozen=True, eq=False)
class Reduction:
    """basis (n, r): the model's DOFs from the r reduced coordinates, six per tie and then the modes.

    stiffness, mass (r, r). The modes' stiffness is the square of their angular frequencies, their mass one.
    """

    basis: FloatArray
    stiffness: FloatArray
    mass: FloatArray
    n_modes: int


def craig_bampton(model: FiniteElementModel, ties: Sequence[Tie], n_modes: int) -> Reduction:
    """Reduce a part to its ties and `n_modes` fixed-interface modes.

    Raises PartFileError for ties that cannot hold or too many modes, PhysicsError for a part that is not in one piece.
    """
    check_ties(model, ties)
    rigid = [tie.coupling == "rigid" for tie in ties]
    tied, boundary = _rigid_boundary(model, [tie for tie, is_rigid in zip(ties, rigid, strict=True) if is_rigid])
    averaged = [averaging_matrix(model, tie) for tie, is_rigid in zip(ties, rigid, strict=True) if not is_rigid]
    constraints = csr_array(vstack(averaged)) if averaged else csr_array((0, model.size))
    interior = np.setdiff1d(np.arange(model.size), tied)
    _check_one_piece(model, tied)
    if n_modes > len(interior) - constraints.shape[0] - 1:
        raise PartFileError(model.source, f"found {len(interior)} inner DOFs, too few for {n_modes} modes")
    solve = _solver(model, interior, csr_array(constraints[:, interior]), held=len(tied) > 0)
    statics = _static_modes(model, boundary, constraints, interior, solve)
    modes = _fixed_interface_modes(model, interior, solve, constraints.shape[0], n_modes)
    order = np.argsort(np.repeat(~np.array(rigid), 6), kind="stable")
    statics = statics[:, np.argsort(order)]
    return _reduced(model, statics, modes)


def _rigid_boundary(model: FiniteElementModel, ties: Sequence[Tie]) -> tuple[IntArray, FloatArray]:
    """Tied rows, and T of all rigid ties spread over the model's rows: (n, 6 k)."""
    boundary = np.zeros((model.size, 6 * len(ties)))
    tied = []
    for j, tie in enumerate(ties):
        rows, block = rigid_rows(model, tie)
        boundary[rows, 6 * j : 6 * j + 6] = block
        tied.append(rows)
    return np.concatenate(tied) if tied else np.zeros(0, dtype=np.int64), boundary


def _solver(model: FiniteElementModel, interior: IntArray, constraints: csr_array, held: bool) -> ConstrainedSolve:
    stiffness = csr_array(model.stiffness[interior][:, interior])
    rigid = np.zeros((len(interior), 0)) if held else _free_motions(model)
    try:
        return constrained_solver(stiffness, constraints, rigid)
    except np.linalg.LinAlgError as error:
        cause = f"its stiffness is singular ({error}); check that every DOF has stiffness"
        raise PhysicsError(model.name, "part is held by its interfaces", 0.0, 0.0, cause) from error


def _check_one_piece(model: FiniteElementModel, tied: IntArray) -> None:
    """Raises PhysicsError when a piece of the mesh is joined to nothing: not to the rest, a rigid tie or the ground."""
    pieces, of_row = connected_components(model.stiffness, directed=False)
    if pieces == 1:
        return
    rigid = model.rigid_body_modes(about=model.coordinates.mean(axis=0))
    force = np.linalg.norm(model.stiffness @ rigid, axis=1)
    held = force > 1e-9 * np.linalg.norm(rigid) * abs(model.stiffness).max()
    held[tied] = True
    loose = pieces - len(np.unique(of_row[held]))
    if loose:
        cause = f"of its {pieces} pieces, {loose} are not held; check that the volumes of the mesh share their nodes"
        raise PhysicsError(model.name, "pieces of the part", float(pieces), 1.0, cause)


def _free_motions(model: FiniteElementModel) -> FloatArray:
    """Rigid motions that cost no energy: (n, 6) for a free part, fewer columns for one that is held."""
    rigid = model.rigid_body_modes(about=model.coordinates.mean(axis=0))
    rigid = rigid / np.linalg.norm(rigid, axis=0)
    energy, combination = eigh(rigid.T @ (model.stiffness @ rigid))
    stiffest = float(model.stiffness.diagonal().max())
    return np.asarray(rigid @ combination[:, energy < 1e-10 * stiffest])


def _static_modes(
    model: FiniteElementModel,
    boundary: FloatArray,
    constraints: csr_array,
    interior: IntArray,
    solve: ConstrainedSolve,
) -> FloatArray:
    """(n, 6 k): the part's shape for a unit motion of each condensation node, the others held; rigid ties first."""
    m = constraints.shape[0]
    load = np.hstack([-(model.stiffness @ boundary)[interior], np.zeros((len(interior), m))])
    wanted = np.hstack([-(constraints @ boundary), np.eye(m)])
    shapes = np.hstack([boundary, np.zeros((model.size, m))])
    shapes[interior] = solve(load, wanted)
    return shapes


def _fixed_interface_modes(
    model: FiniteElementModel, interior: IntArray, solve: ConstrainedSolve, n_constraints: int, n_modes: int
) -> FloatArray:
    """(n, n_modes): lowest modes with all condensation nodes held, by shift-invert about zero; signs are fixed."""
    shapes = np.zeros((model.size, n_modes))
    if n_modes == 0:
        return shapes
    stiffness = csr_array(model.stiffness[interior][:, interior])
    mass = csr_array(model.mass[interior][:, interior])
    held = np.zeros((n_constraints, 1))
    n = len(interior)
    inverse = LinearOperator((n, n), matvec=lambda b: solve(b.reshape(-1, 1), held).ravel(), dtype=float)
    start = np.random.default_rng(0).standard_normal(n)
    try:
        modes = eigsh(stiffness, n_modes, M=mass, sigma=0.0, OPinv=inverse, v0=start)[1]
    except ArpackError as error:
        raise PartFileError(model.source, f"its fixed-interface modes were not found ({error})") from error
    shapes[interior] = modes
    return _normalised(model, shapes)


def _normalised(model: FiniteElementModel, shapes: FloatArray) -> FloatArray:
    """One Rayleigh-Ritz step to full accuracy; the first entry close to the largest is made positive."""
    rotation = eigh(shapes.T @ (model.stiffness @ shapes), shapes.T @ (model.mass @ shapes))[1]
    shapes = shapes @ rotation
    size = np.abs(shapes)
    leading = np.argmax(size > 0.99 * size.max(axis=0), axis=0)
    return np.asarray(shapes * np.sign(shapes[leading, np.arange(shapes.shape[1])]))


def _reduced(model: FiniteElementModel, statics: FloatArray, modes: FloatArray) -> Reduction:
    """Project; what Craig-Bampton makes zero or one exactly (K between statics and modes, modal mass) is written so."""
    first = statics.shape[1]
    basis = np.hstack([statics, modes])
    stiffness = np.zeros((basis.shape[1],) * 2)
    stiffness[:first, :first] = _symmetric(statics.T @ (model.stiffness @ statics))
    stiffness[first:, first:] = np.diag(np.einsum("ij,ij->j", modes, model.stiffness @ modes))
    mass = _symmetric(basis.T @ (model.mass @ basis))
    mass[first:, first:] = np.eye(modes.shape[1])
    return Reduction(basis, stiffness, mass, modes.shape[1])


def _symmetric(matrix: FloatArray) -> FloatArray:
    return np.asarray((matrix + matrix.T) / 2.0)
