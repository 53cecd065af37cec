"""One map on axes: filled contours with their levels, or cells where values are numbers of modes; the worst marked."""

from __future__ import annotations

from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import FloatArray
from .panels import Panel

COLOURS = "cividis"  # the same to the colour-blind

_LEVELS = 12
_MOST_POINTS = 400  # along a side: more than a panel has pixels
_FLAT = 1e-9  # relative, of values that are one


def fill(figure: Any, axes: Any, x: FloatArray, y: FloatArray, panel: Panel) -> None:
    """Draw the panel's values (y, x). Where they are NaN there is hatching."""
    rows, columns = _thinned(len(y)), _thinned(len(x))
    values = panel.values[np.ix_(rows, columns)]
    if np.isnan(values).any():
        everywhere = np.ones((2, len(columns)))
        axes.contourf(x[columns], y[[0, -1]], everywhere, levels=[0.5, 1.5], colors=["white"], hatches=["////"])
    if panel.modes:
        _cells(figure, axes, x[columns], y[rows], values, panel.modes)
    elif np.nanmax(values) - np.nanmin(values) > _FLAT * np.nanmax(np.abs(values)):
        _contours(figure, axes, x[columns], y[rows], values, panel.unit)
    else:
        around = np.nanmean(values) + np.array([-1.0, 1.0]) * max(1e-3 * float(np.nanmax(np.abs(values))), 1e-300)
        axes.contourf(x[columns], y[rows], values, levels=around, colors=[_colour(0.5)])
    if panel.worst:
        row, column = panel.worst_place()
        mark(axes, x[column], y[row])


def mark(axes: Any, x: float, y: float) -> None:
    """Mark the worst pose."""
    axes.plot(x, y, marker="v", color="white", markeredgecolor="black", markersize=8, clip_on=False, zorder=5)


def add_bar(figure: Any, axes: Any, drawn: Any, unit: str) -> Any:
    """A colour bar under its unit."""
    bar = figure.colorbar(drawn, ax=axes, shrink=0.8, pad=0.08)
    bar.ax.set_title(unit, fontsize=8)
    bar.ax.tick_params(labelsize=7)
    return bar


def halo() -> list[Any]:
    """What makes small text readable on any colour."""
    from matplotlib.patheffects import withStroke

    return [withStroke(linewidth=1.5, foreground="white")]


def _contours(figure: Any, axes: Any, x: FloatArray, y: FloatArray, values: FloatArray, unit: str) -> None:
    filled = axes.contourf(x, y, values, levels=_LEVELS, cmap=COLOURS)
    levels = filled.levels[::2]
    seen = ["white" if level < np.mean(filled.levels) else "black" for level in levels]
    _label(axes, axes.contour(x, y, values, levels=levels, colors=seen, linewidths=0.5))
    add_bar(figure, axes, filled, unit)


def _label(axes: Any, lines: Any) -> None:
    """The level of each contour on its longest piece, no two at the same place along it."""
    step = np.min(np.diff(lines.levels), initial=np.inf)
    digits = 2 + max(1, ceil(np.log10(np.max(np.abs(lines.levels)) / step))) if np.isfinite(step) else 4
    for k, (level, pieces) in enumerate(zip(lines.levels, lines.allsegs, strict=True)):
        longest = max(pieces, key=len, default=())
        if len(longest) > 2:
            x, y = longest[int(len(longest) * ((0.5 + 0.382 * k) % 1.0))]
            axes.text(x, y, f"{level:.{digits}g}", fontsize=6, ha="center", va="center", path_effects=halo())


def _cells(figure: Any, axes: Any, x: FloatArray, y: FloatArray, values: FloatArray, modes: int) -> None:
    """A colour for each mode, the same on every panel."""
    from matplotlib.colors import ListedColormap

    colours = ListedColormap([_colour(place) for place in np.linspace(0.0, 1.0, modes)])
    limits = {"vmin": 0.5, "vmax": modes + 0.5}
    drawn = axes.pcolormesh(_edges(x), _edges(y), values, cmap=colours, rasterized=True, **limits)
    add_bar(figure, axes, drawn, "mode").set_ticks(np.arange(1, modes + 1))


def _edges(values: FloatArray) -> FloatArray:
    """Of cells round values, the first and the last of which are at the rim."""
    return np.concatenate([values[:1], (values[1:] + values[:-1]) / 2.0, values[-1:]])


def _colour(place: float) -> Any:
    from matplotlib import colormaps

    return colormaps[COLOURS](place)


def _thinned(count: int) -> NDArray[np.intp]:
    """Which of so many places are drawn, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, min(count, _MOST_POINTS)).round().astype(np.intp))
