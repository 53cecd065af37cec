"""Lengths in millimetres, angles in degrees and figures, for messages and tables."""

from __future__ import annotations

from collections.abc import Mapping

from .description.units import Dimension, Units

_UNITS = Units(length="mm", angle="deg")


def readable(value: float, dimension: Dimension) -> str:
    """A value [m, rad] in words, such as ``1275 mm`` or ``12.5 deg``."""
    return f"{_number(value, dimension)} {dimension.label(_UNITS)}"


def readable_range(low: float, high: float, dimension: Dimension) -> str:
    """Bounds [m, rad] in words, such as ``500 .. 900 mm``."""
    return f"{_number(low, dimension)} .. {readable(high, dimension)}"


def pose_text(pose: Mapping[str, float], coordinates: Mapping[str, Dimension]) -> str:
    """A pose [m, rad] in words, such as ``nutation 70 deg, z 1275 mm``."""
    return ", ".join(f"{name} {readable(pose[name], dimension)}" for name, dimension in coordinates.items())


def figure(value: float, digits: int = 4) -> str:
    """A number to so many digits, such as ``11600`` or ``0.35``; with an exponent only beyond a thousand million."""
    text = f"{value:.{digits}g}"
    return f"{value:.0f}" if "e+" in text and abs(value) < 1e9 else text


def _number(value: float, dimension: Dimension) -> str:
    """To 1 um or 0.001 degrees."""
    return f"{round(float(value) / dimension.factor(_UNITS), 3) + 0.0:.10g}"
