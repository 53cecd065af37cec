"""Simulation in time, exact between samples."""

from __future__ import annotations

from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike
from scipy.linalg import expm, matrix_balance

from ..arrays import FloatArray
from ..errors import PrsError, UnknownNameError
from .quantity import real_numbers

Hold = Literal["linear", "constant"]
"""What the force does between samples (first-order or zero-order hold)."""


def time_response(
    a: FloatArray, b: FloatArray, c: FloatArray, d: FloatArray, forces: ArrayLike, step: float, hold: Hold
) -> FloatArray:
    """y (t, p) of x' = A x + B f, y = C x + D f from rest, for forces (t, 3) or (t, 6) every `step` seconds."""
    samples = _samples(forces)
    seconds = _seconds(step)
    if hold not in get_args(Hold):
        raise UnknownNameError("hold", str(hold), get_args(Hold))
    forward, first, last = discrete(a, b, seconds, hold)
    driven = samples[:-1] @ first.T + samples[1:] @ last.T
    states = np.zeros((len(samples), len(a)))
    for k, push in enumerate(driven):
        states[k + 1] = forward @ states[k] + push
    return np.asarray(states @ c.T + samples @ d.T)


def discrete(a: FloatArray, b: FloatArray, step: float, hold: Hold) -> tuple[FloatArray, FloatArray, FloatArray]:
    """x_k+1 = F x_k + G f_k + L f_k+1, from one exponential (Van Loan): exp [A h, B h, 0; 0, 0, 1; 0, 0, 0]."""
    balanced, (scale, _) = matrix_balance(a, permute=False, separate=True)
    n, m = b.shape
    block = np.zeros((n + 2 * m, n + 2 * m))
    block[:n, :n] = step * balanced
    block[:n, n : n + m] = step * b / scale[:, None]
    block[n : n + m, n + m :] = np.eye(m)
    power = expm(block)
    if not np.all(np.isfinite(power)):
        raise PrsError(f"step: found {step:g} s, too long for a system this fast; expected a fraction of its periods")
    forward = scale[:, None] * power[:n, :n] / scale
    held, ramp = scale[:, None] * power[:n, n : n + m], scale[:, None] * power[:n, n + m :]
    return (forward, held, np.zeros_like(held)) if hold == "constant" else (forward, held - ramp, ramp)


def _samples(forces: ArrayLike) -> FloatArray:
    expected = "(samples, 3), forces [N], or (samples, 6), with moments [N m]"
    samples = real_numbers("forces", forces, f"an array of shape {expected}")
    if samples.ndim != 2 or samples.shape[1] not in (3, 6) or not len(samples):
        raise PrsError(f"forces: found an array of shape {samples.shape}, expected {expected}")
    return np.hstack([samples, np.zeros((len(samples), 6 - samples.shape[1]))])


def _seconds(step: float) -> float:
    expected = "a time between samples above zero [s]"
    seconds = real_numbers("step", step, expected)
    if seconds.ndim or seconds <= 0.0:
        raise PrsError(f"step: found {step!r}, expected {expected}")
    return float(seconds)
