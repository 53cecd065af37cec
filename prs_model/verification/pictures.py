"""The pictures of a verification: mode shapes, MAC, discrepancies over poses, error against coordinates."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np

from ..arrays import FloatArray
from ..modes.figure_file import matplotlib_told, write_figure
from ..modes.picture import draw_modes
from .report import Comparison, ModelRun, VerificationReport
from .tables import pose_texts

_MARKERS = "osD^vPX*"


@dataclass(frozen=True)
class Picture:
    """File names, the first one for pages, and what the picture shows."""

    files: tuple[str, ...]
    caption: str


def draw(report: VerificationReport, folder: Path) -> tuple[Picture, ...]:
    """Draw everything into a folder: curves and bars as SVG and PNG, mode shapes as PNG.

    Raises PrsError, or MissingExtraError without matplotlib.
    """
    plt = _matplotlib()
    made = [
        _both(_discrepancies(plt, report), folder, "discrepancies", "Discrepancy of every frequency at every pose."),
        _both(_mac(plt, report), folder, "mac", f"MAC at {pose_texts(report)[0]}, pairs on the diagonal."),
        _both(_frequencies(plt, report), folder, "frequencies", "Frequencies at every pose."),
    ]
    if report.curve:
        caption = "Largest discrepancy at any pose against the number of coordinates."
        made.append(_both(_curve(plt, report), folder, "curve", caption))
    runs = (*report.models, *report.shown)
    return (*made, *(_shapes(report, run, folder) for run in runs))


def _both(figure: Any, folder: Path, name: str, caption: str) -> Picture:
    files = f"{name}.svg", f"{name}.png"
    for file in files:
        write_figure(figure, folder / file)
    return Picture(files, caption)


def _shapes(report: VerificationReport, run: ModelRun, folder: Path) -> Picture:
    """Mode shapes of one model at the first pose (Figures 8 and 9 of the paper)."""
    name = f"modes_{run.name}.png"
    caption = f"Mode shapes, {run.name} ({run.title}), {pose_texts(report)[0]}"
    modes = run.reference_modes
    shown = replace(modes, eigenvalues=modes.eigenvalues[: report.count], shapes=modes.shapes[:, : report.count])
    draw_modes(shown, folder / name, caption)
    return Picture((name,), caption)


def _discrepancies(plt: SimpleNamespace, report: VerificationReport) -> Any:
    """Bars of every mode at every pose, a panel for each reduction and complete model (Figure 13 of the paper)."""
    rows, columns = len(report.shown), len(report.models)
    width = 1.5 + 0.45 * max(len(report.poses), 8)
    figure = plt.Figure(figsize=(width * columns, 2.1 * rows + 0.9), layout="constrained")
    for row, run in enumerate(report.shown):
        for column, model in enumerate(report.models):
            axes = figure.add_subplot(rows, columns, row * columns + column + 1)
            _bars(plt, axes, report.comparison(run.name, model.name))
            axes.set_title(f"{run.name} against {model.name}", fontsize=9)
            axes.set_ylabel("discrepancy/%", fontsize=8)
            if row == rows - 1:
                axes.set_xlabel("pose (numbers as in the tables)", fontsize=8)
    figure.legend(*figure.axes[0].get_legend_handles_labels(), loc="outside lower center", ncols=8, fontsize=8)
    return figure


def _bars(plt: SimpleNamespace, axes: Any, comparison: Comparison) -> None:
    poses, count = comparison.discrepancies.shape
    places, colours = np.arange(1, poses + 1), _colours(plt, count)
    for k in range(count):
        offset = (k - (count - 1) / 2.0) * 0.8 / count
        values = 1e2 * comparison.discrepancies[:, k]
        axes.bar(
            places + offset,
            values,
            0.8 / count,
            color=colours[k],
            edgecolor="black",
            linewidth=0.3,
            label=f"mode {k + 1}",
        )
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set_xticks(places)
    axes.tick_params(labelsize=7)


def _mac(plt: SimpleNamespace, report: VerificationReport) -> Any:
    """MAC matrices at the first pose, figures in the cells (Figure 10 of the paper)."""
    rows, columns = len(report.models), len(report.shown)
    figure = plt.Figure(figsize=(3.3 * columns, 3.3 * rows + 0.6), layout="constrained")
    for row, model in enumerate(report.models):
        for column, run in enumerate(report.shown):
            axes = figure.add_subplot(rows, columns, row * columns + column + 1)
            _cells(axes, report.comparison(run.name, model.name))
            axes.set_ylabel(f"mode of {model.name}", fontsize=8)
            axes.set_xlabel(f"mode of {run.name}", fontsize=8)
    bar = figure.colorbar(plt.scale, ax=figure.axes, shrink=0.6)
    bar.set_label("MAC", fontsize=8)
    return figure


def _cells(axes: Any, comparison: Comparison) -> None:
    matrix = comparison.mac[0]
    axes.imshow(matrix, cmap="Blues", vmin=0.0, vmax=1.0)
    for (i, j), value in np.ndenumerate(matrix):
        axes.text(j, i, f"{value:.2f}", ha="center", va="center", fontsize=6, color="white" if value > 0.6 else "black")
    axes.set_xticks(range(len(matrix)), [str(partner + 1) for partner in comparison.partners[0]])
    axes.set_yticks(range(len(matrix)), [str(k + 1) for k in range(len(matrix))])
    axes.tick_params(labelsize=7)


def _frequencies(plt: SimpleNamespace, report: VerificationReport) -> Any:
    """Every frequency over the poses: complete models as lines, reductions as marks."""
    figure = plt.Figure(figsize=(2.5 + 0.45 * max(len(report.poses), 8), 5.5), layout="constrained")
    axes = figure.add_subplot()
    places = np.arange(1, len(report.poses) + 1)
    for run, style in zip(report.models, ("-", "--"), strict=False):
        label = [f"{run.name}: {run.title}", *[None] * (report.count - 1)]
        axes.plot(
            places, run.frequencies[:, : report.count], style, marker="_", color="black", linewidth=1.0, label=label
        )
    colours = _colours(plt, len(report.shown))
    for run, marker, colour in zip(report.shown, _MARKERS, colours, strict=False):
        label = [run.name, *[None] * (report.count - 1)]
        frequencies = run.frequencies[:, : report.count]
        edge = {"markeredgecolor": "black", "markeredgewidth": 0.4, "markersize": 4}
        axes.plot(places, frequencies, marker, color=colour, label=label, **edge)
    axes.set_xticks(places)
    axes.set_xlabel("pose (numbers as in the tables)")
    axes.set_ylabel("frequency/Hz")
    figure.legend(loc="outside lower center", ncols=2, fontsize=8)
    return figure


def _curve(plt: SimpleNamespace, report: VerificationReport) -> Any:
    """Largest discrepancy over all poses against the number of coordinates, a line for each reduction."""
    figure = plt.Figure(figsize=(6.0, 4.2), layout="constrained")
    axes = figure.add_subplot()
    models = {model.name for model in report.models}
    points = [run for run in report.reductions if run.name in report.curve and run.own in models]
    families = list(dict.fromkeys(run.family for run in points))
    for family, marker, colour in zip(families, _MARKERS, _colours(plt, len(families)), strict=False):
        runs = [run for run in points if run.family == family]
        largest = [1e2 * report.comparison(run.name, run.own).largest.max() for run in runs]
        sizes = [run.size for run in runs]
        label = f"{family}, against {runs[0].own}"
        axes.semilogy(sizes, largest, "-", marker=marker, color=colour, markeredgecolor="black", label=label)
        for run, size, error in zip(runs, sizes, largest, strict=True):
            axes.annotate(str(run.modes_per_part), (size, error), (3, 3), textcoords="offset points", fontsize=7)
    axes.grid(True, which="both", linewidth=0.3, color="0.8")
    axes.set_xlabel("number of coordinates (figures at the points: modes per part)")
    axes.set_ylabel("largest discrepancy/%")
    axes.legend(fontsize=8)
    return figure


def _colours(plt: SimpleNamespace, count: int) -> FloatArray:
    """Colours that stay apart in grey and to the colour-blind."""
    return np.asarray(plt.colours(np.linspace(0.0, 1.0, count)))


def check_drawing() -> None:
    """Raise MissingExtraError now if pictures could not be drawn later."""
    _matplotlib()


def _matplotlib() -> SimpleNamespace:
    with matplotlib_told("drawing a verification"):
        from matplotlib import colormaps
        from matplotlib.cm import ScalarMappable
        from matplotlib.figure import Figure
    return SimpleNamespace(Figure=Figure, scale=ScalarMappable(cmap="Blues"), colours=colormaps["cividis"])
