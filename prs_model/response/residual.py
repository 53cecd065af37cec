"""What a truncated modal sum lacks, made up for without solving for more modes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from scipy.linalg import cholesky, solve_triangular

from ..arrays import FloatArray
from ..errors import PrsError
from ..linear_algebra import positive_definite_pencil
from .points import Point
from .static import solved_scaled

if TYPE_CHECKING:
    from ..modes import Modes

_BLOCKS = 5
_NEW = 1e-8  # in the energy norm, so that 1e-16 of the compliance is lost
_INFINITE = 1e-16  # of the largest 1 / lambda: a motion without mass


def is_truncated(modes: Modes) -> bool:
    """Whether the system has motions beyond these modes."""
    return len(modes.eigenvalues) < modes.system.size


def with_residual_vectors(modes: Modes, loads: FloatArray) -> Modes:
    """The modes, and vectors that stand for those left out in the response to loads (n, c).

    The first are the static responses to the loads, purged of the kept modes Phi: r = K^-1 (1 - M Phi Phi^T) loads, so
    that the response at rest is exact. Further ones, K^-1 M r and so on, give their inertia forces (moments of the
    response in omega^2). Orthogonalised in K and M they are superposed as modes are. A structure that is free has
    K - s M in place of K, s so small that only its rigid-body modes notice.
    Raises PrsError when all modes kept are rigid-body modes.
    """
    shift, pencil = _pencil(modes)
    scale = 1.0 / np.sqrt(np.diag(pencil))[:, None]
    factor = cholesky(pencil * scale * scale.T, lower=True)
    half = solve_triangular(factor, modes.system.mass * scale * scale.T, lower=True)
    mass = solve_triangular(factor, half.T, lower=True)  # in coordinates in which K - s M is the identity
    kept = factor.T @ (modes.shapes / scale)
    basis, block = kept / np.linalg.norm(kept, axis=0), solve_triangular(factor, scale * loads, lower=True)
    for _ in range(_BLOCKS):
        block = _new_directions(block, basis)
        basis, block = np.hstack([basis, block]), mass @ block
    added = basis[:, kept.shape[1] :]
    flexibility, turn = np.linalg.eigh(added.T @ mass @ added)
    flexibility, turn = flexibility[::-1], turn[:, ::-1]
    flexibility = np.maximum(flexibility, _INFINITE * np.max(1.0 / (modes.eigenvalues - shift)))
    shapes = scale * solve_triangular(factor, added @ turn, lower=True, trans="T") / np.sqrt(flexibility)
    return replace(
        modes,
        eigenvalues=np.concatenate([modes.eigenvalues, 1.0 / flexibility + shift]),
        shapes=np.hstack([modes.shapes, shapes]),
    )


def residual_compliance(modes: Modes, to: Point, at: Point) -> FloatArray:
    """(6, 6): the first of these vectors alone, sum phi phi^T / lambda over the modes left out; zero when none is.

    Raises PrsError when all modes kept are rigid-body modes.
    """
    if not is_truncated(modes):
        return np.zeros((6, 6))
    _, pencil = _pencil(modes)
    load = at.motion.T - modes.system.mass @ (modes.shapes @ (modes.shapes.T @ at.motion.T))
    return np.asarray(to.motion @ solved_scaled(pencil, load))


def _pencil(modes: Modes) -> tuple[float, FloatArray]:
    """s and K - s M."""
    shift, pencil = positive_definite_pencil(modes.system.mass, modes.system.stiffness)
    if shift != 0.0 and modes.is_rigid.all():
        raise PrsError(f"found {len(modes.eigenvalues)} modes, all at 0 Hz, expected some above; ask for more modes")
    return shift, pencil


def _new_directions(block: FloatArray, basis: FloatArray) -> FloatArray:
    """Orthonormal directions of a block (n, c) beyond those of an orthonormal basis (n, k)."""
    sizes = np.linalg.norm(block, axis=0)
    block = block[:, sizes > 0.0] / sizes[sizes > 0.0]
    for _ in range(2):
        block = block - basis @ (basis.T @ block)
    directions, size, _ = np.linalg.svd(block, full_matrices=False)
    new = directions[:, size > _NEW]
    return np.linalg.qr(new - basis @ (basis.T @ new))[0]
