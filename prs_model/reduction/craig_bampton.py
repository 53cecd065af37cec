"""Craig-Bampton reduction with the boundary projected first: eq. (4)-(8) in the order that costs least.

Rigid ties enter by projection, u_b = T U, before anything is factorized; averaged ties as constraints D u = U. Both
give exact statics of the tied part, and the fixed-interface modes of the part with all condensation nodes held.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh
from scipy.sparse import coo_array, csr_array, vstack
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

from ..arrays import FloatArray, IntArray
from ..errors import PartFileError, PhysicsError
from ..finite_elements import FiniteElementModel
from ..finite_elements.rigid_motion import transfer
from .constrained import ConstrainedSolve, constrained_solver
from .coupling import Tie, averaging_matrix, check_ties, rigid_rows

REPEATED = 1e-12  # of the largest weight: what remains of a shape that others make up
PAIR = 1e-4  # frequencies this close together (relative) belong to one symmetry

logger = logging.getLogger("prs_model")


@dataclass(frozen=True, eq=False)
class Reduction:
    """basis (n, r): the model's DOFs from the r reduced coordinates, six per tie and then the modes.

    stiffness, mass (r, r). The modes' stiffness is the square of their angular frequencies, their mass one.
    """

    basis: FloatArray
    stiffness: FloatArray
    mass: FloatArray
    n_modes: int


@dataclass(frozen=True, eq=False)
class HeldPart:
    """A part with its condensation nodes held, factorized.

    boundary (n, 6 k): T of the k ties, zero for averaged ones, whose D are in constraints (m, n), and in `averaged`
    the coordinates they belong to. interior: rows that are not rigidly tied. solve: see `constrained_solver`.
    """

    model: FiniteElementModel
    boundary: FloatArray
    constraints: csr_array
    averaged: IntArray
    interior: IntArray
    solve: ConstrainedSolve


def craig_bampton(model: FiniteElementModel, ties: Sequence[Tie], n_modes: int) -> Reduction:
    """Reduce a part to its ties and `n_modes` fixed-interface modes.

    Raises PartFileError for ties that cannot hold or too many modes, PhysicsError for a part that is not in one piece.
    """
    part = hold(model, ties)
    return _reduced(model, ties, static_modes(part), fixed_interface_modes(part, n_modes))


def ritz_craig_bampton(model: FiniteElementModel, ties: Sequence[Tie]) -> Reduction:
    """Reduce a part to its ties and, in place of modes, its fixed-interface responses to the ties' inertia forces.

    These load-dependent Ritz vectors (Wilson, Yuan and Dickens, Earthquake Engineering & Structural Dynamics 10, 1982),
    six per tie at most, make the receptance between the ties exact to the third power of the squared frequency.
    Raises as `craig_bampton` does.
    """
    part = hold(model, ties)
    statics = static_modes(part)
    return _reduced(model, ties, statics, _ritz_vectors(part, statics))


def hold(model: FiniteElementModel, ties: Sequence[Tie]) -> HeldPart:
    """Hold a part at its ties. Raises PartFileError for ties that cannot hold, PhysicsError for a loose piece."""
    check_ties(model, ties)
    boundary = np.zeros((model.size, 6 * len(ties)))
    is_tied = np.zeros(model.size, dtype=bool)
    averages, averaged = [csr_array((0, model.size))], [np.zeros(0, dtype=np.int64)]
    for j, tie in enumerate(ties):
        columns = np.arange(6 * j, 6 * j + 6)
        if tie.coupling == "rigid":
            rows, block = rigid_rows(model, tie)
            boundary[np.ix_(rows, columns)] = block
            is_tied[rows] = True
        else:
            averages.append(averaging_matrix(model, tie))
            averaged.append(columns)
    _check_one_piece(model, ties)
    logger.info("%s: factorizing, %d DOFs and %d interfaces", model.name, model.size, len(ties))
    constraints, interior = csr_array(vstack(averages)), np.flatnonzero(~is_tied)
    solve = _solver(model, interior, csr_array(constraints[:, interior]), held=bool(np.any(is_tied)))
    return HeldPart(model, boundary, constraints, np.concatenate(averaged), interior, solve)


def static_modes(part: HeldPart) -> FloatArray:
    """(n, 6 k): the part's shape for a unit motion of each condensation node, the others held."""
    wanted = -(part.constraints @ part.boundary)
    wanted[np.arange(len(part.averaged)), part.averaged] += 1.0
    shapes = part.boundary.copy()
    shapes[part.interior] = part.solve(-(part.model.stiffness @ part.boundary)[part.interior], wanted)
    return shapes


def response(part: HeldPart, loads: FloatArray) -> FloatArray:
    """(n, c): the part's shape under loads (n, c), with its condensation nodes held."""
    shapes = np.zeros_like(loads)
    shapes[part.interior] = part.solve(loads[part.interior], np.zeros((part.constraints.shape[0], loads.shape[1])))
    return shapes


def fixed_interface_modes(part: HeldPart, n_modes: int) -> FloatArray:
    """(n, n_modes): lowest modes with all condensation nodes held, by shift-invert about zero; signs are fixed.

    One more is computed, to warn when the last one kept is half of a pair.
    """
    model, n, m = part.model, len(part.interior), part.constraints.shape[0]
    if n_modes == 0:
        return np.zeros((model.size, 0))
    if n_modes > n - m - 1:
        taken = "" if n else ": its interfaces take all nodes of the part; select their seats only"
        raise PartFileError(model.source, f"found {n - m} inner DOFs, too few for {n_modes} modes{taken}")
    count = min(n_modes + 1, n - m - 1)
    logger.info("%s: finding %d fixed-interface modes", model.name, n_modes)
    shapes = np.zeros((model.size, count))
    inner, inner_mass = (csr_array(each[part.interior][:, part.interior]) for each in (model.stiffness, model.mass))
    held = np.zeros((m, 1))
    inverse = LinearOperator((n, n), matvec=lambda b: part.solve(b.reshape(-1, 1), held).ravel(), dtype=float)
    start = np.random.default_rng(0).standard_normal(n)
    try:
        shapes[part.interior] = eigsh(inner, count, M=inner_mass, sigma=0.0, OPinv=inverse, v0=start)[1]
    except ArpackError as error:
        raise PartFileError(model.source, f"its fixed-interface modes were not found ({error})") from error
    shapes = _normalised(model, shapes)
    last = np.einsum("ij,ij->j", shapes, model.stiffness @ shapes)[n_modes - 1 :]
    if len(last) == 2 and last[1] < last[0] * (1.0 + PAIR) ** 2:
        logger.warning(
            "%s: its modes %d and %d are a pair, of which one would be kept; keep one mode more or less",
            *(model.name, n_modes, n_modes + 1),
        )
    return shapes[:, :n_modes]


def _ritz_vectors(part: HeldPart, statics: FloatArray) -> FloatArray:
    """(n, p <= 6 k): orthonormal in M and K, spanning the responses to M statics; what repeats others is left out."""
    model = part.model
    shapes = response(part, model.mass @ statics)
    overlap = shapes.T @ (model.mass @ shapes)
    size = np.sqrt(np.diag(overlap))
    moving = size > 0.0
    shapes, size = shapes[:, moving] / size[moving], size[moving]
    weight, combination = eigh(overlap[np.ix_(moving, moving)] / np.outer(size, size))
    apart = weight > REPEATED * weight.max(initial=0.0)
    if not apart.any():
        return np.zeros((model.size, 0))
    return _normalised(model, shapes @ (combination[:, apart] / np.sqrt(weight[apart])))


def _solver(model: FiniteElementModel, interior: IntArray, constraints: csr_array, held: bool) -> ConstrainedSolve:
    stiffness = csr_array(model.stiffness[interior][:, interior])
    rigid = np.zeros((len(interior), 0)) if held else _free_motions(model)
    try:
        return constrained_solver(stiffness, constraints, rigid)
    except np.linalg.LinAlgError as error:
        cause = f"its stiffness is singular ({error}); check that every DOF has stiffness"
        raise PhysicsError(model.name, "part is held by its interfaces", 0.0, 0.0, cause) from error


def _check_one_piece(model: FiniteElementModel, ties: Sequence[Tie]) -> None:
    """Raises PhysicsError unless the pieces of the mesh are one part: joined by rigid ties or by the ground."""
    pieces, of_row = connected_components(model.stiffness, directed=False)
    if pieces == 1:
        return
    rigid = model.rigid_body_modes(about=model.coordinates.mean(axis=0))
    force = np.linalg.norm(model.stiffness @ rigid, axis=1)
    held = force > 1e-9 * np.linalg.norm(rigid) * abs(model.stiffness).max()
    groups = [of_row[held], *(of_row[model.rows_of(tie.indices)] for tie in ties if tie.coupling == "rigid")]
    one = np.concatenate([np.full(len(group), group[0]) for group in groups if len(group)] or [np.arange(0)])
    joined = coo_array((np.ones(len(one)), (one, np.concatenate(groups))), shape=(pieces, pieces))
    whole = connected_components(joined, directed=False)[0]
    if whole > 1:
        cause = (
            f"the {pieces} pieces of the mesh are not one part: neither a rigid interface nor the ground joins them; "
            "check that the volumes of the mesh share their nodes"
        )
        raise PhysicsError(model.name, "pieces of the part", float(whole), 1.0, cause)


def _free_motions(model: FiniteElementModel) -> FloatArray:
    """(n, r): the model's DOFs in its rigid motions that cost no energy."""
    return np.asarray(model.rigid_body_modes(about=model.coordinates.mean(axis=0)) @ _free(model))


def _free(model: FiniteElementModel) -> FloatArray:
    """(6, r): rigid motions of the nodes' centre that cost no energy; r = 6 for a free part, 0 for one that is held."""
    rigid = model.rigid_body_modes(about=model.coordinates.mean(axis=0))
    size = np.linalg.norm(rigid, axis=0)
    energy, combination = eigh((rigid / size).T @ (model.stiffness @ (rigid / size)))
    stiffest = float(model.stiffness.diagonal().max())
    return np.asarray(combination[:, energy < 1e-10 * stiffest] / size[:, None])


def _normalised(model: FiniteElementModel, shapes: FloatArray) -> FloatArray:
    """One Rayleigh-Ritz step to full accuracy; the first entry close to the largest is made positive.

    Raises PhysicsError when the mass matrix is negative in one of the shapes.
    """
    mass = shapes.T @ (model.mass @ shapes)
    lowest = float(np.min(np.linalg.eigvalsh(mass), initial=1.0))
    if not lowest > 0.0:
        cause = "a flipped sign or digit in the mass matrix: compare it with the one in the part's solver"
        raise PhysicsError(model.name, "mass is not negative", -lowest, 0.0, cause)
    rotation = eigh(shapes.T @ (model.stiffness @ shapes), mass)[1]
    shapes = shapes @ rotation
    size = np.abs(shapes)
    leading = np.argmax(size > 0.99 * size.max(axis=0), axis=0)
    return np.asarray(shapes * np.sign(shapes[leading, np.arange(shapes.shape[1])]))


def _reduced(model: FiniteElementModel, ties: Sequence[Tie], statics: FloatArray, modes: FloatArray) -> Reduction:
    """Project; what is exactly zero or one is written so: K of free motions, K of statics and modes, modal mass."""
    first = statics.shape[1]
    basis = np.hstack([statics, modes])
    stiffness = np.zeros((basis.shape[1],) * 2)
    stiffness[:first, :first] = _without(_free_coordinates(model, ties), statics.T @ (model.stiffness @ statics))
    stiffness[first:, first:] = np.diag(np.einsum("ij,ij->j", modes, model.stiffness @ modes))
    mass = _symmetric(basis.T @ (model.mass @ basis))
    mass[first:, first:] = np.eye(modes.shape[1])
    return Reduction(basis, stiffness, mass, modes.shape[1])


def _free_coordinates(model: FiniteElementModel, ties: Sequence[Tie]) -> FloatArray:
    """(6 k, r): the ties' coordinates in the part's free motions."""
    arms = np.array([tie.position for tie in ties]) - model.coordinates.mean(axis=0)
    return np.asarray(transfer(arms).reshape(-1, 6) @ _free(model))


def _without(free: FloatArray, stiffness: FloatArray) -> FloatArray:
    """The stiffness (n, n) with none left in the motions `free` (n, r), which only round-off has put there."""
    if free.shape[1] == len(stiffness):
        return np.zeros_like(stiffness)
    q = np.linalg.qr(free)[0]
    others = np.eye(len(stiffness)) - q @ q.T
    return _symmetric(others @ stiffness @ others)


def _symmetric(matrix: FloatArray) -> FloatArray:
    return np.asarray((matrix + matrix.T) / 2.0)
