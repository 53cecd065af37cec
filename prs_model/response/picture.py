"""Frequency responses drawn: magnitude and phase over frequency."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..modes.figure_file import matplotlib_figure, write_figure

if TYPE_CHECKING:
    from .frequency_response import FrequencyResponse

_LEAST = 1e-6  # of the largest magnitude: what is smaller is round-off of a motion that there is not
_MANY = 6  # curves that a legend may cover
_BESIDE = {"loc": "upper left", "bbox_to_anchor": (1.0, 1.0)}
_LINES = ("-", "--", ":", "-.")  # told apart in greyscale


def draw(responses: Mapping[str, FrequencyResponse], path: Path, pairs: Sequence[str], title: str = "") -> None:
    """Draw entries such as ``u``, ``w/u`` of one response, or of several of one quantity by their names.

    Entries of one unit share a panel. The file appears only when it is complete. Raises PrsError, MissingExtraError.
    """
    by_unit: dict[str, list[str]] = {}
    first = next(iter(responses.values()))
    for pair in pairs:
        by_unit.setdefault(first.unit(pair), []).append(pair)
    figure = matplotlib_figure("drawing a frequency response")(figsize=(7.5 * len(by_unit), 5.6), layout="constrained")
    panels = figure.subplots(2, len(by_unit), sharex=True, squeeze=False, height_ratios=(2, 1))
    for k, (unit, some) in enumerate(by_unit.items()):
        _panel(panels[:, k], responses, some, unit)
    figure.suptitle(title, fontsize=10, parse_math=False)
    write_figure(figure, path)


def _panel(axes: Any, responses: Mapping[str, FrequencyResponse], pairs: Sequence[str], unit: str) -> None:
    curves = {(name, pair): each.curve(pair) for name, each in responses.items() for pair in pairs}
    least = _LEAST * max(float(np.abs(curve).max()) for curve in curves.values())
    for number, (name, response) in enumerate(responses.items()):
        for place, pair in enumerate(pairs):
            drawn = np.where(np.abs(curves[name, pair]) > least, curves[name, pair], np.nan)
            style = _LINES[(number if len(responses) > 1 else place) % len(_LINES)]
            label = f"{'/'.join(dict.fromkeys(pair.split('/')))} {name}".strip()
            axes[0].plot(response.frequencies, np.abs(drawn), style, color=f"C{place}", label=label)
            axes[1].plot(response.frequencies, np.degrees(np.angle(drawn)), style, color=f"C{place}")
    axes[0].set_ylabel(f"{response.quantity} / ({unit})")
    if least > 0.0:
        axes[0].set_yscale("log")
    axes[0].legend(title="response/force", fontsize=8, **(_BESIDE if len(curves) > _MANY else {}))
    axes[1].set(xlabel="frequency / Hz", ylabel="phase / deg", ylim=(-190, 190), yticks=(-180, -90, 0, 90, 180))
    for each in axes:
        each.grid(True, alpha=0.3)
