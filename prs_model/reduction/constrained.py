"""Equilibrium of a part under averaged constraints, from one positive definite factorization."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.linalg import qr
from scipy.sparse import csr_array

from ..arrays import FloatArray
from ..linear_algebra import Solve, factorize

ConstrainedSolve = Callable[[FloatArray, FloatArray], FloatArray]


def constrained_solver(stiffness: csr_array, constraints: csr_array, rigid: FloatArray) -> ConstrainedSolve:
    """A function (f, g) -> x solving [K D^T; D 0] [x; lambda] = [f; g] for f (n, c) and g (m, c).

    stiffness: K (n, n), singular exactly on the columns of `rigid`, R (n, r). constraints: D (m, n), which must hold R.
    With G b = K^-1 b after R is pinned at r DOFs (exact for any balanced load), x = G (f - D^T lambda) + R alpha, where
    lambda and alpha follow from D x = g and the balance R^T (f - D^T lambda) = 0. So the dense rows of D never enter a
    sparse factorization. Raises numpy.linalg.LinAlgError when K is singular otherwise.
    """
    solve = _pinned(stiffness, rigid)
    m, r = constraints.shape[0], rigid.shape[1]
    if m == 0:
        return lambda f, g: solve(f)
    response = solve(constraints.T.toarray())
    flexibility, motion = constraints @ response, constraints @ rigid
    scale = float(np.linalg.norm(flexibility))
    small = np.block([[-flexibility / scale, motion], [motion.T, np.zeros((r, r))]])
    if np.linalg.cond(small) > 1e14:
        raise np.linalg.LinAlgError("averaged interfaces repeat each other, or leave the part free to move")

    def constrained(f: FloatArray, g: FloatArray) -> FloatArray:
        free = solve(f)
        unknown = np.linalg.solve(small, np.concatenate([g - constraints @ free, scale * (rigid.T @ f)]))
        return np.asarray(free - response @ (unknown[:m] / scale) + rigid @ unknown[m:])

    return constrained


def _pinned(stiffness: csr_array, rigid: FloatArray) -> Solve:
    """K^-1 with R held at as many well-chosen DOFs as it has columns; those DOFs come back as zero."""
    if rigid.shape[1] == 0:
        return factorize(stiffness)
    scaled = rigid / np.linalg.norm(rigid, axis=0)
    pins = qr(scaled.T, mode="r", pivoting=True)[1][: rigid.shape[1]]
    free = np.setdiff1d(np.arange(stiffness.shape[0]), pins)
    solve = factorize(csr_array(stiffness[free][:, free]))

    def pinned(b: FloatArray) -> FloatArray:
        x = np.zeros_like(b, dtype=float)
        x[free] = solve(np.ascontiguousarray(b[free]))
        return x

    return pinned
