"""Frequencies at which to ask for a response: close enough round each mode that no peak falls between them."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from .quantity import six_digits

if TYPE_CHECKING:
    from ..modes import Modes

_FIRST, _LAST = 0.1, 1.25  # of the first and the last frequency shown
_OFFSETS = np.array([0.2, 0.4, 0.7, 1.0, 1.5, 2.2, 3.2, 5.0, 8.0, 13.0, 20.0, 32.0])  # in half-power half-widths
_NARROW = 1e-4  # damping ratio of what has none: the flanks of a peak without end


def band(modes: Modes, ratios: FloatArray, count: int = 8, lines: int = 1000) -> FloatArray:
    """Frequencies (f,) [Hz], ascending: evenly from below the first mode to beyond the `count`-th, closer round each.

    ratios (k,): damping ratios of the modes, of `damping_ratios`; nan for rigid-body modes. The largest line of a mode
    is within 1 % of its peak for ratios from 0.0001 on. Modes without damping are approached, not met. Rigid-body modes
    do not count; empty where there are no others. Lines have six digits, as many as a universal file has.
    """
    elastic = modes.frequencies[modes.frequencies > 0.0]
    if not elastic.size:
        return np.zeros(0)
    low, high = _FIRST * elastic[0], _LAST * elastic[:count][-1]
    even = np.linspace(low, high, lines)
    peaks = around(modes, ratios)
    every = np.concatenate([even, peaks[(peaks > low) & (peaks < high)]])
    kept = np.unique([six_digits(float(each)) for each in every])
    return kept[~np.isin(kept, modes.frequencies[ratios == 0.0])]


def around(modes: Modes, ratios: FloatArray) -> FloatArray:
    """Frequencies (f,) [Hz] at the modes that are damped and on the flanks of all, in no order."""
    frequencies, widths = modes.frequencies, np.maximum(np.nan_to_num(ratios), _NARROW)
    sides = np.concatenate([-_OFFSETS, _OFFSETS])
    flanks = frequencies[:, None] * (1.0 + widths[:, None] * sides)
    found = np.concatenate([flanks.ravel(), frequencies[ratios > 0.0]])
    return np.asarray(found[found > 0.0])
