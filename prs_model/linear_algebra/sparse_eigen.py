"""The lowest eigenvalues of a large sparse pencil, free or held, by Lanczos on a shifted inverse."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.linalg import ArpackError, LinearOperator, eigsh

from ..arrays import FloatArray
from ..errors import PrsError
from .eigen import lowest_modes
from .factorize import factorize

SHIFT = 1e-6  # of trace K / trace M, a rate far above the first elastic one of a fine mesh
DENSE = 500  # rows up to which all eigenvalues cost nothing


def lowest_eigenvalues(stiffness: csr_array, mass: csr_array, count: int) -> FloatArray:
    """The `count` lowest eigenvalues [rad^2/s^2] of K x = lambda M x, ascending, those of rigid motion among them.

    K (n, n) and M (n, n) are positive semi-definite. K - s M with s < 0 is factorized once, so that rigid motions need
    no care. Raises PrsError when the pencil is singular or the iteration does not converge.
    """
    n = stiffness.shape[0]
    if min(stiffness.diagonal().sum(), mass.diagonal().sum()) <= 0.0:
        raise PrsError("no frequencies: the part has no mass, or no stiffness")
    if n <= DENSE:
        return lowest_modes(mass.toarray(), stiffness.toarray(), count)[0]
    shift = -SHIFT * float(stiffness.diagonal().sum() / mass.diagonal().sum())
    try:
        solve = factorize(csr_array(stiffness - shift * mass))
    except np.linalg.LinAlgError as error:
        raise PrsError(f"no frequencies: a motion meets neither stiffness nor mass ({error})") from error
    inverse = LinearOperator((n, n), matvec=solve, dtype=float)
    start = np.random.default_rng(0).standard_normal(n)
    try:
        values = eigsh(
            stiffness, min(count, n - 1), M=mass, sigma=shift, OPinv=inverse, v0=start, return_eigenvectors=False
        )
    except ArpackError as error:
        raise PrsError(f"no frequencies: the iteration did not converge ({error})") from error
    return np.sort(values)
