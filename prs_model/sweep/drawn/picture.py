"""Maps drawn: one panel a mode or direction, the worst pose marked, unreachable poses hatched.

Two coordinates that vary make a filled contour map, polar where one is a full turn and the other a radius from zero on;
one makes curves; more make the map of the first two at the middle of the others. A list of poses becomes points.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from textwrap import fill as fill_text
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...arrays import FloatArray
from ...description.units import Dimension
from ...errors import PrsError, UnknownNameError
from ...modes.figure_file import matplotlib_figure, write_figure
from ...readable import readable
from .contours import COLOURS, add_bar, fill, halo, mark
from .panels import DRAWABLE, Panel, panels_of

if TYPE_CHECKING:
    import xarray

_READABLE = {"rad": (180.0 / np.pi, "deg"), "m": (1e3, "mm")}
_WIDTH = 52  # of the lines of a title


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
    """Draw a quantity of a sweep's dataset, a panel for each mode or direction, into a PNG, SVG or PDF file.

    quantity: of DRAWABLE. The worst pose, of the lowest frequency or the largest compliance, is marked. The file
    appears only when it is complete. Raises PrsError or MissingExtraError.
    """
    figure_class = matplotlib_figure("drawing a map")
    _check(data, quantity)
    dims = tuple(map(str, data["reason"].dims))
    if len(dims) > 2:
        middle = {name: data.sizes[name] // 2 for name in dims[2:]}
        data = data.isel(middle)
        dims = dims[:2]
    panels = panels_of(data, quantity)
    columns = min(len(panels), 3)
    rows = ceil(len(panels) / columns)
    figure = figure_class(figsize=(4.6 * columns, 4.2 * rows + 0.9), layout="constrained")
    kind = _kind(data, dims)
    for k, panel in enumerate(panels):
        projection = "polar" if kind is _polar else None
        axes = figure.add_subplot(rows, columns, k + 1, projection=projection)
        kind(figure, axes, data, panel)
        axes.set_title(panel.title + _worst_in_words(data, panel), fontsize=8)
    figure.suptitle("\n".join([str(data.attrs.get("title", "")), _subtitle(data, quantity)]), fontsize=11)
    write_figure(figure, path)


def check_drawing(quantity: str, asked: Collection[str], poses: int) -> None:
    """Raise UnknownNameError, MissingExtraError or PrsError now if a map of what is asked could not be drawn later."""
    if quantity not in DRAWABLE:
        raise UnknownNameError("quantity to draw", quantity, list(DRAWABLE))
    if DRAWABLE[quantity] not in asked:
        raise PrsError(f"picture: the map has no {quantity}; ask for the quantity {DRAWABLE[quantity]}")
    if poses < 2:
        raise PrsError("picture: found one pose, expected several; prs-model modes --picture draws the shapes at one")
    matplotlib_figure("drawing a map")


def _check(data: xarray.Dataset, quantity: str) -> None:
    check_drawing(quantity, data.attrs["quantities"].split(), data["reason"].size)
    if not np.isfinite(data[quantity].values).any():
        raise PrsError(f"picture: no pose has a value of {quantity}: all are unreachable, or the machine is not held")


def _kind(data: xarray.Dataset, dims: tuple[str, ...]) -> Any:
    if dims == ("pose",):
        return _points
    if len(dims) == 1:
        return _curve
    first, second = (_axis(data, name) for name in dims)
    is_polar = (first.is_radius and second.is_turn) or (second.is_radius and first.is_turn)
    return _polar if is_polar else _rectangular


def _worst_in_words(data: xarray.Dataset, panel: Panel) -> str:
    if not panel.worst:
        return ""
    place = dict(zip(data["reason"].dims, panel.worst_place(), strict=True))
    there = data.isel(place)
    varying = [each for name, each in there.coords.items() if data[name].dims and "pose" not in each.dims]
    where = ", ".join(_value(each) for each in varying if each.attrs.get("units") in _READABLE)
    return f"\n{'largest' if panel.worst > 0 else 'lowest'} {panel.value_text()}\n{fill_text(f'at {where}', _WIDTH)}"


def _polar(figure: Any, axes: Any, data: xarray.Dataset, panel: Panel) -> None:
    names = tuple(map(str, data["reason"].dims))
    first, second = (_axis(data, name) for name in names)
    upright = bool(first.is_radius and second.is_turn)
    radius, turn, panel = (first, second, panel) if upright else (second, first, panel.transposed())
    angles = turn.values
    if np.ptp(angles) < 2.0 * np.pi - 1e-9:
        angles, panel = np.append(angles, angles[0] + 2.0 * np.pi), panel.closed()
    fill(figure, axes, angles, radius.shown, panel)
    axes.set_rlabel_position(22.5)
    axes.tick_params(labelsize=7)
    axes.set_rlim(0.0, radius.shown[-1])
    axes.set_rticks(np.linspace(radius.shown[0], radius.shown[-1], 4)[1:])
    for label in axes.get_yticklabels():
        label.set_path_effects(halo())
    axes.grid(alpha=0.25)
    figure.supxlabel(f"radius: {radius.label}; angle: {turn.label}", fontsize=9)


def _rectangular(figure: Any, axes: Any, data: xarray.Dataset, panel: Panel) -> None:
    x, y = (_axis(data, str(name)) for name in data["reason"].dims)
    fill(figure, axes, x.shown, y.shown, panel.transposed())
    _name_axes(axes, x.label, y.label)


def _curve(figure: Any, axes: Any, data: xarray.Dataset, panel: Panel) -> None:
    axis, values = _axis(data, str(data["reason"].dims[0])), panel.values
    axes.plot(axis.shown, values, color="C0")
    if panel.worst:
        (low,) = panel.worst_place()
        mark(axes, axis.shown[low], values[low])
    for start, stop in _runs(np.isnan(values)):
        axes.axvspan(axis.shown[start], axis.shown[stop], facecolor="none", edgecolor="grey", hatch="////", linewidth=0)
    _name_axes(axes, axis.label, panel.unit)
    axes.grid(alpha=0.3)


def _points(figure: Any, axes: Any, data: xarray.Dataset, panel: Panel) -> None:
    """A list over the first two coordinates of which it has more than one value."""
    along = [_axis(data, str(name)) for name in data.coords if data[name].dims == ("pose",)]
    x, y = ([axis for axis in along if np.ptp(axis.values) > 0.0] + along * 2)[:2]
    there = np.isfinite(panel.values)
    drawn = axes.scatter(x.shown[there], y.shown[there], c=panel.values[there], cmap=COLOURS, s=12)
    axes.plot(x.shown[~there], y.shown[~there], "x", color="grey", markersize=4)
    if panel.worst:
        (low,) = panel.worst_place()
        mark(axes, x.shown[low], y.shown[low])
    add_bar(figure, axes, drawn, panel.unit)
    _name_axes(axes, x.label, y.label)


def _name_axes(axes: Any, x: str, y: str) -> None:
    axes.set_xlabel(x, fontsize=8)
    axes.set_ylabel(y, fontsize=8)
    axes.tick_params(labelsize=7)


def _axis(data: xarray.Dataset, name: str) -> _Axis:
    values = np.asarray(data[name].values, dtype=float)
    factor, unit = _READABLE.get(str(data[name].attrs.get("units")), (1.0, ""))
    return _Axis(name, values, factor * values, f"{name} / {unit}" if unit else name)


def _subtitle(data: xarray.Dataset, quantity: str) -> str:
    """What is shown, and the coordinates that stay where they are."""
    fixed = [_value(each) for each in data.coords.values() if not each.dims and "units" in each.attrs]
    what = str(data[quantity].attrs.get("long_name", quantity))
    if quantity.startswith("frf"):
        what += f" of {data.attrs['band_low_hz']:g} .. {data.attrs['band_high_hz']:g} Hz"
    missing = "hatching"
    if data["reason"].dims == ("pose",):
        missing = "crosses"
        over = [
            name for name in map(str, data.coords) if data[name].dims == ("pose",) and np.ptp(data[name].values) > 0.0
        ]
        fixed += [f"poses of any {', '.join(over[2:])}"] if over[2:] else []
    return ", ".join([what, *fixed]) + (f"; {missing}: out of reach" if data["reason"].values.any() else "")


def _value(coordinate: xarray.DataArray) -> str:
    kind = Dimension(angle=1) if coordinate.attrs.get("units") == "rad" else Dimension(length=1)
    return f"{coordinate.name} {readable(float(coordinate), kind)}"


def _runs(marks: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """First and last place of each run of marks."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], marks, [False]]).astype(int)))
    return [(int(start), int(stop) - 1) for start, stop in edges.reshape(-1, 2)]
