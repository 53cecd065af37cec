"""Maps drawn: one panel a mode, the lowest pose marked, unreachable poses hatched.

Two coordinates that vary make a filled contour map, polar where one is a full turn and the other a radius from zero on;
one makes curves; more make the map of the first two at the middle of the others. A list of poses becomes points.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray
from ..description.units import Dimension
from ..errors import MissingExtraError, PrsError
from ..modes.figure_file import write_figure
from ..readable import readable

if TYPE_CHECKING:
    import xarray

_COLOURS = "cividis"  # the same to the colour-blind
_LEVELS = 12
_MOST_POINTS = 400  # along a side of a contour map: more than a panel has pixels
_READABLE = {"rad": (180.0 / np.pi, "deg"), "m": (1e3, "mm")}


@dataclass(frozen=True, eq=False)
class _Axis:
    """A pose coordinate as drawn: its values, those in readable units, and what to call it."""

    name: str
    values: FloatArray
    shown: FloatArray
    label: str

    @property
    def is_turn(self) -> bool:
        """Whether it is an angle that goes once round, give or take one step."""
        span, step = np.ptp(self.values), np.max(np.diff(self.values), initial=0.0)
        return self.label.endswith("deg") and bool(2.0 * np.pi - 1.01 * step <= span <= 2.0 * np.pi + 1e-9)

    @property
    def is_radius(self) -> bool:
        return bool(self.values[0] >= 0.0 and self.values[0] <= 0.1 * np.ptp(self.values))


def draw(data: xarray.Dataset, path: Path, quantity: str = "frequency") -> None:
    """Draw a quantity of a sweep's dataset, one panel for each mode, into a PNG, SVG or PDF file.

    quantity: any that has one value a mode, such as ``frequency`` or ``tracked_frequency``. The file appears only when
    it is complete. Raises PrsError or MissingExtraError.
    """
    figure_class = matplotlib_figure()
    if quantity not in data or data[quantity].ndim != data["reason"].ndim + 1:
        raise PrsError(f"picture: found no quantity '{quantity}' with a value for each mode; expected frequency")
    dims = tuple(map(str, data["reason"].dims))
    if not dims:
        raise PrsError("picture: found one pose, expected several; prs-model modes --picture draws the shapes at one")
    note = ""
    if dims != ("pose",) and len(dims) > 2:
        middle = {name: data.sizes[name] // 2 for name in dims[2:]}
        data = data.isel(middle)
        dims, note = dims[:2], ", ".join(_value(data[name]) for name in middle)
    values = data[quantity].transpose(*dims, ...)
    count = values.shape[-1]
    columns = min(count, 3)
    figure = figure_class(figsize=(4.6 * columns, 3.9 * ceil(count / columns) + 0.6), layout="constrained")
    panel = _panel_for(data, dims)
    for k in range(count):
        panel(figure, (ceil(count / columns), columns, k + 1), data, np.asarray(values[..., k]), _title(values, k))
    figure.suptitle("\n".join(filter(None, [str(data.attrs.get("title", "")), _fixed(data, dims), note])), fontsize=11)
    write_figure(figure, path)


def matplotlib_figure() -> Any:
    """matplotlib's Figure. Raises MissingExtraError, or PrsError for a matplotlib that cannot be used."""
    try:
        from matplotlib.figure import Figure
    except ImportError as error:
        raise MissingExtraError("matplotlib", "plot", "drawing a map") from error
    except ValueError as error:  # a setting of its own that it does not take
        raise PrsError(f"matplotlib cannot be used: {error}") from error
    return Figure


def _panel_for(data: xarray.Dataset, dims: tuple[str, ...]) -> Any:
    if dims == ("pose",):
        return _points
    if len(dims) == 1:
        return _curve
    first, second = (_axis(data, name) for name in dims)
    if (first.is_radius and second.is_turn) or (second.is_radius and first.is_turn):
        return _polar
    return _rectangular


def _title(values: xarray.DataArray, k: int) -> str:
    character = str(values["character"].values[k]) if "character" in values.coords else ""
    low, high = np.nanmin(values[..., k]), np.nanmax(values[..., k])
    return "\n".join(filter(None, [f"mode {k + 1}: {low:.4g} .. {high:.4g} Hz", character]))


def _polar(figure: Any, place: tuple[int, int, int], data: xarray.Dataset, values: FloatArray, title: str) -> None:
    names = tuple(map(str, data["reason"].dims))
    first, second = (_axis(data, name) for name in names)
    radius, turn, values = (first, second, values) if second.is_turn else (second, first, values.T)
    angles = turn.values
    if np.ptp(angles) < 2.0 * np.pi - 1e-9:
        angles, values = np.append(angles, angles[0] + 2.0 * np.pi), np.column_stack([values, values[:, :1]])
    axes = figure.add_subplot(*place, projection="polar")
    _contours(figure, axes, angles, radius.shown, values)
    axes.set_rlabel_position(22.5)
    axes.tick_params(labelsize=7)
    axes.set_rticks(np.linspace(radius.shown[0], radius.shown[-1], 4)[1:])
    axes.grid(alpha=0.25)
    axes.set_title(title, fontsize=9)
    axes.set_xlabel(f"radius {radius.label}, round {turn.label}", fontsize=7)


def _rectangular(
    figure: Any, place: tuple[int, int, int], data: xarray.Dataset, values: FloatArray, title: str
) -> None:
    names = tuple(map(str, data["reason"].dims))
    y, x = (_axis(data, name) for name in names)
    axes = figure.add_subplot(*place)
    _contours(figure, axes, x.shown, y.shown, values)
    axes.set_xlabel(x.label, fontsize=8)
    axes.set_ylabel(y.label, fontsize=8)
    axes.tick_params(labelsize=7)
    axes.set_title(title, fontsize=9)


def _contours(figure: Any, axes: Any, x: FloatArray, y: FloatArray, values: FloatArray) -> None:
    """Filled and labelled contours of values (y, x), the lowest marked, what is unreachable hatched."""
    row, column = np.unravel_index(np.nanargmin(values), values.shape)
    lowest = x[column], y[row]
    rows, columns = _thinned(len(y)), _thinned(len(x))
    x, y, values = x[columns], y[rows], values[np.ix_(rows, columns)]
    axes.set_facecolor("white")
    missing = np.isnan(values)
    if missing.any():
        axes.contourf(x, y, missing.astype(float), levels=[0.5, 1.5], colors=["none"], hatches=["////"])
    if np.ptp(values[~missing]) > 1e-9 * np.abs(values[~missing]).max():
        filled = axes.contourf(x, y, values, levels=_LEVELS, cmap=_COLOURS)
        lines = axes.contour(x, y, values, levels=filled.levels[::2], colors="black", linewidths=0.5)
        _label(axes, lines)
        figure.colorbar(filled, ax=axes, shrink=0.8, pad=0.08).set_label("Hz", fontsize=8)
    axes.plot(*lowest, marker="v", color="white", markeredgecolor="black", markersize=8, clip_on=False, zorder=5)


def _label(axes: Any, lines: Any) -> None:
    """The level of each contour on its longest piece, no two at the same place along it."""
    from matplotlib.patheffects import withStroke

    for k, (level, pieces) in enumerate(zip(lines.levels, lines.allsegs, strict=True)):
        longest = max(pieces, key=len, default=())
        if len(longest) > 2:
            x, y = longest[int(len(longest) * ((0.5 + 0.382 * k) % 1.0))]
            halo = [withStroke(linewidth=1.5, foreground="white")]
            axes.text(x, y, f"{level:.4g}", fontsize=6, ha="center", va="center", path_effects=halo)


def _curve(figure: Any, place: tuple[int, int, int], data: xarray.Dataset, values: FloatArray, title: str) -> None:
    axis = _axis(data, str(data["reason"].dims[0]))
    axes = figure.add_subplot(*place)
    axes.plot(axis.shown, values, color="C0")
    low = int(np.nanargmin(values))
    axes.plot(axis.shown[low], values[low], marker="v", color="white", markeredgecolor="black", markersize=8)
    for start, stop in _runs(np.isnan(values)):
        axes.axvspan(axis.shown[start], axis.shown[stop], facecolor="none", edgecolor="grey", hatch="////", linewidth=0)
    axes.set_xlabel(axis.label, fontsize=8)
    axes.set_ylabel("Hz", fontsize=8)
    axes.grid(alpha=0.3)
    axes.set_title(title, fontsize=9)


def _points(figure: Any, place: tuple[int, int, int], data: xarray.Dataset, values: FloatArray, title: str) -> None:
    """A list over the two coordinates that vary most of their range."""
    named = [str(name) for name in data.coords if data[name].dims == ("pose",)]
    x, y = (_axis(data, name) for name in (named * 2)[:2])
    there = np.isfinite(values)
    axes = figure.add_subplot(*place)
    drawn = axes.scatter(x.shown[there], y.shown[there], c=values[there], cmap=_COLOURS, s=12)
    axes.plot(x.shown[~there], y.shown[~there], "x", color="grey", markersize=4)
    low = int(np.nanargmin(values))
    axes.plot(x.shown[low], y.shown[low], marker="v", color="white", markeredgecolor="black", markersize=8)
    figure.colorbar(drawn, ax=axes, shrink=0.8).set_label("Hz", fontsize=8)
    axes.set_xlabel(x.label, fontsize=8)
    axes.set_ylabel(y.label, fontsize=8)
    axes.set_title(title, fontsize=9)


def _axis(data: xarray.Dataset, name: str) -> _Axis:
    values = np.asarray(data[name].values, dtype=float)
    factor, unit = _READABLE.get(str(data[name].attrs.get("units")), (1.0, ""))
    return _Axis(name, values, factor * values, f"{name} / {unit}" if unit else name)


def _fixed(data: xarray.Dataset, dims: tuple[str, ...]) -> str:
    """The coordinates that stay where they are, in words."""
    return ", ".join(_value(each) for each in data.coords.values() if not each.dims and "units" in each.attrs)


def _value(coordinate: xarray.DataArray) -> str:
    kind = Dimension(angle=1) if coordinate.attrs.get("units") == "rad" else Dimension(length=1)
    return f"{coordinate.name} {readable(float(coordinate), kind)}"


def _thinned(count: int) -> NDArray[np.intp]:
    """Which of so many places are drawn, the first and the last among them."""
    return np.unique(np.linspace(0, count - 1, min(count, _MOST_POINTS)).round().astype(np.intp))


def _runs(marks: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last place of each run of marks."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], marks, [False]]).astype(int)))
    return [(int(start), int(stop) - 1) for start, stop in edges.reshape(-1, 2)]
