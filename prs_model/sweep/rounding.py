"""How far frequencies of the dense solver are off by rounding: a first-order estimate, not a proof."""

from __future__ import annotations

import numpy as np

from ..arrays import BoolArray, FloatArray

_RIGID = 1e-8  # of the slowest rate of a held coordinate, as in Modes.is_rigid
_SHIFT = 1e-3  # of that rate: how far below zero the spectrum of a partly free machine is looked at from


def is_rigid(eigenvalues: FloatArray, rate: FloatArray) -> BoolArray:
    """Whether modes (.., k) strain nothing: eigenvalues [rad^2/s^2] that are round-off beside the rate (..)."""
    return np.asarray(eigenvalues <= _RIGID * rate[..., None])


def rounding(
    eigenvalues: FloatArray, shapes: FloatArray, mass: FloatArray, stiffness: FloatArray, rate: FloatArray
) -> FloatArray:
    """Estimated relative error of frequencies (.., k), mass-normalised shapes (.., n, k); NaN of those that are zero.

    mass, stiffness: diagonals (.., n). rate: linear_algebra.slowest_rate (..) [rad^2/s^2].
    Matrices assembled and factorised with unit e are off by about n e beside sqrt(K_ii K_jj) and sqrt(M_ii M_jj), and
    the eigensolver by n e of the largest mu = 1 / lambda. To first order a mode x with x^T M x = 1 has

        |d lambda| / lambda = n e (x^T diag(K) x / lambda + x^T diag(M) x + lambda / lambda_1),

    half of which its frequency has (Higham, Accuracy and Stability of Numerical Algorithms, 2nd ed., 10.1).
    """
    rigid = is_rigid(eigenvalues, rate)
    slowest = np.where(rigid[..., :1], _SHIFT * rate[..., None], eigenvalues[..., :1])
    values = np.where(rigid, np.nan, eigenvalues)
    inertia, strain = (np.sum(each[..., None] * shapes**2, axis=-2) for each in (mass, stiffness))
    unit = shapes.shape[-2] * np.finfo(float).eps
    return np.asarray(0.5 * unit * (strain / values + inertia + values / slowest))
