"""Force coordinates of a contact: the form of a part's matrices that is smooth in where the contact is."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arrays import FloatArray, IntArray
from ..errors import PrsError


def flexibility_form(stiffness: FloatArray, contact: IntArray) -> FloatArray:
    """[[K_rr + K_rc C, C^T], [C, F]] with F = K_cc^-1 and C = -F K_cr, in the order of the coordinates.

    c is the contact, r the rest. These are the stiffness with the contact free, its motion when the rest moves, and its
    flexibility: smooth functions of where the contact is, while K grows like 1/a^3 as an arm a of the part gets short.
    """
    rest = np.setdiff1d(np.arange(len(stiffness)), contact)
    form = stiffness.copy()
    flexibility = np.linalg.inv(stiffness[np.ix_(contact, contact)])
    follow = -flexibility @ stiffness[np.ix_(contact, rest)]
    form[np.ix_(rest, rest)] += stiffness[np.ix_(rest, contact)] @ follow
    form[np.ix_(contact, rest)], form[np.ix_(rest, contact)] = follow, follow.T
    form[np.ix_(contact, contact)] = flexibility
    return form


def force_coordinates(form: FloatArray, contact: IntArray) -> FloatArray:
    """B (n, n) with u = B v, where v has the contact's forces g in place of its motions U_c = C U_r + F g.

    Of a stack of forms (..., n, n), too.
    """
    change = np.zeros_like(form) + np.eye(form.shape[-1])
    change[..., contact, :] = form[..., contact, :]
    return change


def force_stiffness(form: FloatArray, rest: FloatArray, contact: IntArray) -> FloatArray:
    """The stiffness in v, diag(K, F): the flexibility of `form` at the contact, `rest` (n, n) elsewhere, uncoupled."""
    is_contact = np.isin(np.arange(form.shape[-1]), contact)
    both = np.logical_and.outer(is_contact, is_contact)
    neither = np.logical_and.outer(~is_contact, ~is_contact)
    return np.where(both, form, np.where(neither, rest, 0.0))


def positive_mean(matrices: FloatArray, contact: str) -> Callable[[FloatArray], FloatArray]:
    """A function of weights (..., s) that sum to one: exp(sum_k w_k log A_k) of positive definite matrices (s, n, n).

    Positive definite even where weights are negative, and the same for A as for its inverse. Raises PrsError, naming
    the contact, where a matrix is not positive definite to working precision.
    """
    size = np.sqrt(np.maximum(np.diagonal(matrices, axis1=1, axis2=2).mean(axis=0), 0.0))
    scale = np.outer(size, size)
    values, vectors = np.linalg.eigh(matrices / scale) if size.all() else (np.zeros(1), matrices)
    if np.min(values, initial=1.0) <= 0.0:
        raise PrsError(
            f"{contact}: found a flexibility that is not positive definite, lost in round-off; expected a joint about "
            "as stiff as the part: check its stiffness, units and stiffness_factor, or reduce by another method"
        )
    logarithms = (vectors * np.log(values)[:, None, :]) @ vectors.swapaxes(1, 2)

    def mean(weights: FloatArray) -> FloatArray:
        values, vectors = np.linalg.eigh(np.tensordot(weights, logarithms, 1))
        return np.asarray(scale * ((vectors * np.exp(values)[..., None, :]) @ vectors.swapaxes(-1, -2)))

    return mean


def congruent(matrix: FloatArray, change: FloatArray) -> FloatArray:
    """B^T A B, exactly symmetric; of stacks too."""
    product = change.swapaxes(-1, -2) @ matrix @ change
    return np.asarray((product + product.swapaxes(-1, -2)) / 2.0)
