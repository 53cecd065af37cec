"""Where a frequency response is largest: a search near the resonances, then the top of a parabola.

Near a resonance 1 / |h|^2 is a parabola in omega^2, exactly so for a mode alone. The search therefore looks at each
resonance, at its flanks, and at places spread over the band; then a parabola through the best place and its neighbours
gives the top.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ..arrays import FloatArray

_FLANKS = np.array([0.0, 0.25, 0.6, 1.0, 2.0])  # half-widths beside a resonance
_SPREAD = 24  # places over the band besides
_NARROW = 1e-4  # least relative half-width
_SAME = 1e-5  # relative distance of places that count as one, as beside repeated frequencies

Magnitudes = Callable[[FloatArray], FloatArray]
"""|h| (m, f, c) of m poses and c curves at omega (m, f) [rad/s]."""


def places(omega: FloatArray, ratios: FloatArray, band: tuple[float, float]) -> FloatArray:
    """Where to look (m, f) [rad/s], ascending: about modes (m, p) of given damping ratios, within the band [Hz]."""
    low, high = 2.0 * np.pi * np.asarray(band)
    beside = np.concatenate([-_FLANKS[:0:-1], _FLANKS])
    near = omega[:, :, None] * (1.0 + np.maximum(ratios, _NARROW)[:, :, None] * beside)
    spread = np.broadcast_to(np.linspace(low, high, _SPREAD), (len(omega), _SPREAD))
    return np.sort(np.clip(np.concatenate([near.reshape(len(omega), -1), spread], axis=1), low, high), axis=1)


def largest(magnitudes: Magnitudes, omega: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The largest |h| (m, c) and where it is (m, c) [rad/s], sought at ascending omega (m, f) and between them."""
    found = magnitudes(omega)
    best = np.argmax(found, axis=1)[:, None]
    middle = np.take_along_axis(omega[:, :, None], best, axis=1)
    below = np.sum(omega[:, :, None] < (1.0 - _SAME) * middle, axis=1, keepdims=True)
    above = np.sum(omega[:, :, None] > (1.0 + _SAME) * middle, axis=1, keepdims=True)
    last = omega.shape[1] - 1
    three = np.concatenate([np.maximum(below - 1, 0), best, np.minimum(last - above + 1, last)], axis=1)
    at = np.take_along_axis(omega[:, :, None], three, axis=1)
    value = np.take_along_axis(found, three, axis=1)
    top = _top(at, value)
    refined = np.diagonal(magnitudes(top), axis1=1, axis2=2)
    higher = refined > value[:, 1]
    return np.where(higher, refined, value[:, 1]), np.where(higher, top, at[:, 1])


def _top(at: FloatArray, value: FloatArray) -> FloatArray:
    """Lowest point (m, c) of the parabola through 1 / |h|^2 at omega^2 (m, 3, c); the middle where none."""
    x = at**2
    y = (value[:, 1:2] / np.maximum(value, np.finfo(float).tiny)) ** 2
    before, after = x[:, 1] - x[:, 0], x[:, 2] - x[:, 1]
    is_inside = (before > 0.0) & (after > 0.0)
    before, after = np.where(is_inside, before, 1.0), np.where(is_inside, after, 1.0)
    falling, rising = (y[:, 0] - y[:, 1]) / before, (y[:, 2] - y[:, 1]) / after
    curved = is_inside & (falling + rising > 0.0)
    shift = 0.5 * (falling * after - rising * before) / np.where(curved, falling + rising, 1.0)
    return np.asarray(np.sqrt(x[:, 1] + np.where(curved, np.clip(shift, -before, after), 0.0)))
