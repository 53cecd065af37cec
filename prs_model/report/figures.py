"""The figures of one pose, for the page and as files: lines, marks and hatches that can be told apart in grey."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import FloatArray
from ..modes.energy import Energies
from ..modes.figure_file import matplotlib_figure, write_figure
from ..modes.mac import mac
from .study import AtRest, Study

if TYPE_CHECKING:
    from ..response import FrequencyResponse

_HATCHES = ("", "//", "\\\\", "xx", "--", "||", "++", "////", "\\\\\\\\", "xxxx")
_GREYS = ("#31688e", "#bcd35f", "#440154", "#f4d06f", "#35b779", "#e8e8e8", "#7a5195", "#c9a227", "#8fb8de", "#555555")
_LINES = ("-", "--", ":")
_WIDTH = 5.2  # inches: as wide as a phone, so that the letters can be read there
_LEGEND: dict[str, Any] = {"fontsize": 9, "title_fontsize": 9, "handlelength": 1.8, "columnspacing": 1.4}


def report_figure() -> Any:
    """matplotlib's Figure. Raises MissingExtraError, or PrsError for a matplotlib that cannot be used."""
    return matplotlib_figure("drawing a report", "report")


@dataclass(frozen=True)
class Figure:
    """Name of its files without suffix, what it shows, and the same in words for those who cannot see it."""

    name: str
    caption: str
    words: str


def draw_figures(study: Study, first: Study, folder: Path) -> tuple[Figure, ...]:
    """Draw everything of a pose as SVG and PNG into a folder. first: the pose that shapes are compared with."""
    energies = ("kinetic", study.kinetic), ("strain", study.strain)
    drawn = []
    if study.response is not None:
        drawn.append(_frf(study.response, folder))
    if study.at_rest is not None:
        drawn.append(_flexibility(study.at_rest, folder))
    drawn += [_energy(study, folder, *each) for each in energies]
    drawn += [_weak_energy(study, folder, *each) for each in energies]
    return (*drawn, _mac(study, first, folder))


def _save(figure: Any, folder: Path, drawn: Figure) -> Figure:
    figure.draw_without_rendering()
    figure.set_layout_engine("none")  # laid out once is enough
    for suffix in ("svg", "png"):
        write_figure(figure, folder / f"{drawn.name}.{suffix}")
    return drawn


def _frf(response: FrequencyResponse, folder: Path) -> Figure:
    """Figure 11 of the paper: magnitude and phase along u, v, w."""
    figure = report_figure()(figsize=(_WIDTH, 4.4), layout="constrained")
    upper, lower = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
    peaks = []
    for axis, line in zip("uvw", _LINES, strict=True):
        curve = response.curve(axis)
        upper.semilogy(response.frequencies, 1e6 * np.abs(curve), line, label=axis, linewidth=1.5)
        lower.plot(response.frequencies, np.degrees(np.angle(curve)), line, linewidth=1.2)
        top = int(np.argmax(np.abs(curve)))
        peaks.append(f"along {axis} {1e6 * abs(curve[top]):.3g} um/N at {response.frequencies[top]:.1f} Hz")
    upper.set_ylabel("receptance / (µm/N)")
    figure.legend(title="response and force along", ncols=3, loc="outside lower center", **_LEGEND)
    lower.set(xlabel="frequency / Hz", ylabel="phase / deg", ylim=(-190, 190), yticks=(-180, -90, 0, 90, 180))
    for axes in (upper, lower):
        axes.grid(True, alpha=0.3)
    caption = "Frequency response of the end-reference point along u, v, w."
    return _save(figure, folder, Figure("frf", caption, f"{caption} Largest: {'; '.join(peaks)}."))


def _flexibility(rest: AtRest, folder: Path) -> Figure:
    """Figure 15 of the paper: what each mode gives to the static compliance."""
    shares = 100.0 * rest.shares[:, :3]
    figure = report_figure()(figsize=(_WIDTH, 3.4), layout="constrained")
    axes = figure.subplots()
    numbers = np.arange(1.0, len(shares) + 1)
    for k, direction in enumerate("uvw"):
        _bars(axes, numbers + 0.27 * (k - 1), shares[:, k], 0.25, k, f"along {direction}")
    axes.set(xlabel="mode", ylabel="share of the static compliance / %", xticks=numbers)
    axes.margins(y=0.08)
    figure.legend(ncols=3, loc="outside lower center", **_LEGEND)
    tops = [
        f"along {d} mode {np.argmax(shares[:, k]) + 1} with {shares[:, k].max():.1f} %" for k, d in enumerate("uvw")
    ]
    caption = "Contribution of each mode to the static compliance of the end-reference point."
    return _save(figure, folder, Figure("flexibility", caption, f"{caption} Largest: {'; '.join(tops)}."))


def _energy(study: Study, folder: Path, kind: str, energy: Energies) -> Figure:
    """All modes, like parts together."""
    groups = _by_kind(energy, study.modes.system.stems)
    count = len(study.modes.frequencies)
    figure = report_figure()(figsize=(_WIDTH, 3.9), layout="constrained")
    axes = figure.subplots()
    numbers, base = np.arange(1.0, count + 1), np.zeros(count)
    for k, (name, share) in enumerate(groups.items()):
        _bars(axes, numbers, 100.0 * share, 0.7, k, name, base)
        base = base + 100.0 * share
    axes.set(xlabel="mode", ylabel=f"share of the {kind} energy / %", xticks=numbers)
    axes.set(ylim=(0.0, 104.0), yticks=range(0, 101, 20))
    figure.legend(ncols=5, loc="outside lower center", **_LEGEND)
    tops = [f"mode {k + 1} {max(groups, key=lambda name: groups[name][k])}" for k in range(count)]
    caption = f"Where the {kind} energy of each mode is, like parts together."
    return _save(figure, folder, Figure(f"{kind}_energy", caption, f"{caption} Most of it in: {', '.join(tops)}."))


def _weak_energy(study: Study, folder: Path, kind: str, energy: Energies) -> Figure:
    """Figures 16 and 17 of the paper: the first two modes, limb by limb."""
    count = min(2, len(study.modes.frequencies))
    figure = report_figure()(figsize=(_WIDTH, 3.9), layout="constrained")
    panels = figure.subplots(1, count, squeeze=False, sharey=True)[0]
    limbs, stems = study.modes.system.limbs, study.modes.system.stems
    places = list(dict.fromkeys(limbs.get(name, name) for name in energy))
    kinds = list(dict.fromkeys(stems.get(name, name) for name in energy))
    for mode, axes in enumerate(panels):
        table = np.zeros((len(kinds), len(places)))
        for name, share in energy.items():
            table[kinds.index(stems.get(name, name)), places.index(limbs.get(name, name))] += 100.0 * share[mode]
        base = np.zeros(len(places))
        for k, (name, row) in enumerate(zip(kinds, table, strict=True)):
            _bars(axes, np.arange(float(len(places))), row, 0.7, k, name, base)
            base = base + row
        axes.set_title(f"mode {mode + 1}: {study.modes.frequencies[mode]:.1f} Hz", fontsize=9)
        axes.set_xticks(range(len(places)), places, rotation=30, ha="right", fontsize=9)
        axes.margins(y=0.08)
    panels[0].set_ylabel(f"share of the {kind} energy / %")
    figure.legend(*panels[0].get_legend_handles_labels(), ncols=5, loc="outside lower center", **_LEGEND)
    caption = f"Distribution of the {kind} energy of the first modes over limbs and parts."
    return _save(figure, folder, Figure(f"{kind}_energy_by_limb", caption, f"{caption} The numbers are in the tables."))


def _mac(study: Study, first: Study, folder: Path) -> Figure:
    """Of the pose with itself, or with the first pose."""
    matrix = mac(first.modes, study.modes)
    same = study is first
    figure = report_figure()(figsize=(4.6, 3.9), layout="constrained")
    axes = figure.subplots()
    image = axes.imshow(matrix, cmap="Blues", vmin=0.0, vmax=1.0)
    for (i, j), value in np.ndenumerate(matrix):
        axes.text(j, i, f"{value:.2f}", ha="center", va="center", fontsize=7, color="white" if value > 0.6 else "black")
    axes.set_xticks(range(matrix.shape[1]), [str(k + 1) for k in range(matrix.shape[1])])
    axes.set_yticks(range(matrix.shape[0]), [str(k + 1) for k in range(matrix.shape[0])])
    axes.set(xlabel="mode" if same else "mode at this pose", ylabel="mode" if same else "mode at the first pose")
    figure.colorbar(image, label="MAC")
    what = "of the modes with each other: what is not on the diagonal shows shapes alike at the points seen"
    caption = f"MAC {what}." if same else "MAC with the modes of the first pose."
    return _save(figure, folder, Figure("mac", caption, f"{caption} The numbers are in mac.csv."))


def _bars(
    axes: Any, places: FloatArray, heights: FloatArray, width: float, k: int, label: str, base: FloatArray | float = 0.0
) -> None:
    style = {"edgecolor": "black", "linewidth": 0.5, "hatch": _HATCHES[k % 10], "color": _GREYS[k % 10]}
    axes.bar(places, heights, width, bottom=base, label=label, **style)
    axes.grid(True, axis="y", alpha=0.3)
    axes.set_axisbelow(True)


def _by_kind(energy: Energies, stems: Mapping[str, str]) -> Energies:
    groups: Energies = {}
    for name, share in energy.items():
        groups[stems.get(name, name)] = groups.get(stems.get(name, name), 0.0) + share
    return groups
