"""The tables of a verification, for terminals and pages alike."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from ..readable import pose_text
from .report import ModelRun, VerificationReport


@dataclass(frozen=True)
class Table:
    """A heading, rows of cells under a header, and what has to be said about them."""

    heading: str
    header: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    note: str = ""


def tables(report: VerificationReport) -> tuple[Table, ...]:
    """What was compared and at what cost; every complete model at all poses; the first pose in full; the curve."""
    names = [model.name for model in report.models]
    found = [_models(report), _reductions(report)]
    found += [_discrepancies(report, name) for name in names]
    found += [_reference(report, name) for name in names]
    found += [*_published(report), _characters(report)]
    return (*found, *_curve(report))


def _models(report: VerificationReport) -> Table:
    header = ("model", "what it is", "DOFs", "first pose/s", "further pose/s", "peak memory/GB", "largest residual")
    rows = tuple(
        (
            model.name,
            model.title,
            str(model.size),
            _seconds(model.first_seconds),
            _seconds(model.further_seconds),
            "" if model.peak_memory is None else f"{model.peak_memory / 1e9:.2f}",
            "" if model.residuals is None else f"{model.residuals[:, : report.count].max():.0e}",
        )
        for model in report.models
    )
    note = (
        "Times of a pose: the first one reads and factorizes the parts, further ones are the median; poses from the "
        "cache have the times they took when solved. Peak memory is that of the process until the model was done, left "
        "out where poses came from the cache. Residuals bound the error of squared frequencies, relative. "
        f"On {report.environment}."
    )
    return Table("Complete order", header, rows, note)


def _reductions(report: VerificationReport) -> Table:
    header = (
        "reduction",
        "what it is",
        "coordinates",
        "parts/s",
        "pose/ms",
        "ratio",
        "against",
        "least f/f(complete) - 1",
        "in place",
    )
    rows = tuple(_reduction(report, run) for run in report.shown)
    note = (
        "'parts' is reading or reducing all parts. 'ratio' is the complete model's time of a further pose over the "
        "reduction's. 'against' names the complete model with the same interface kinematics. A reduced frequency "
        "cannot lie below that model's, in the order of frequencies, but for round-off and for travelling contacts "
        "between stations; 'in place' is with these contacts reduced where they are (--bounds)."
    )
    return Table("Reductions", header, rows, note)


def _reduction(report: VerificationReport, run: ModelRun) -> tuple[str, ...]:
    margins = report.least_margin(run), report.least_margin_in_place(run)
    times = [_pose_seconds(each) for each in (run, *report.models) if each.name in (run.name, run.own)]
    ratio = f"{times[1] / times[0]:.0f}" if len(times) > 1 else ""
    cells = run.name, run.title, str(run.size), _seconds(run.preparation), f"{1e3 * times[0]:.1f}", ratio, run.own
    return (*cells, *("" if margin is None else f"{margin:+.1e}" for margin in margins))


def _discrepancies(report: VerificationReport, model: str) -> Table:
    """Table 4 of the paper: RMS and largest discrepancy of every pose."""
    found = [report.comparison(run.name, model) for run in report.shown]
    header = ("no.", "pose", *(each.reduction for each in found))
    rows = [
        (f"{k + 1}", pose, *(f"{1e2 * each.rms[k]:.2f}  {1e2 * each.largest[k]:.2f}" for each in found))
        for k, pose in enumerate(pose_texts(report))
    ]
    rows += [("", "all poses", *(f"{1e2 * _rms(each.rms):.2f}  {1e2 * each.largest.max():.2f}" for each in found))]
    rows += [("", "least MAC of a pair", *(f"{each.mac_diagonal.min():.4f}" for each in found))]
    note = f"Root mean square and largest, in %, of the first {report.count} frequencies, modes paired by shape."
    return Table(f"Discrepancies against {model} (Table 4 of the paper)", header, tuple(rows), note)


def _reference(report: VerificationReport, model: str) -> Table:
    """Table 3 of the paper: the frequencies of the first pose."""
    run = next(each for each in report.models if each.name == model)
    found = [(each, report.comparison(each.name, model)) for each in report.shown]
    header = ("mode", f"{model}/Hz", *(each.name for each, _ in found))
    rows = []
    for k in range(report.count):
        cells = [f"{k + 1}", f"{run.frequencies[0, k]:.2f}"]
        for each, comparison in found:
            partner = comparison.partners[0, k]
            number = "" if partner == k else f" (its mode {partner + 1})"
            figures = f"{each.frequencies[0, partner]:.2f}  {1e2 * comparison.discrepancies[0, k]:+.2f}"
            cells.append(f"{figures}  {comparison.mac_diagonal[0, k]:.4f}{number}")
        rows.append(tuple(cells))
    close = report.comparison(found[0][0].name, model).clusters[0] if found else np.zeros(0)
    note = f"Frequency in Hz, its difference from {model} in %, MAC of the pair. {_close_modes(close)}".strip()
    return Table(f"Against {model}, {_first_pose(report)} (Table 3 of the paper)", header, tuple(rows), note)


def _published(report: VerificationReport) -> tuple[Table, ...]:
    """All models beside published frequencies, in the order of frequencies."""
    if not report.published:
        return ()
    runs, first = (*report.shown, *report.models), next(iter(report.published))
    rows = []
    for k in range(report.count):
        known = [f"{each[k]:.2f}" if k < len(each) else "" for each in report.published.values()]
        ours = [
            f"{run.frequencies[0, k]:.2f}{_beside(run.frequencies[0, k], report.published[first], k)}" for run in runs
        ]
        rows.append((f"{k + 1}", *known, *ours))
    header = ("mode", *report.published, *(run.name for run in runs))
    note = f"Frequencies in Hz, in their order, with the difference from '{first}' in %."
    return (Table(f"Beside published frequencies, {_first_pose(report)}", header, tuple(rows), note),)


def _beside(frequency: float, known: Sequence[float], k: int) -> str:
    return f"  {1e2 * (frequency / known[k] - 1.0):+.2f}" if k < len(known) else ""


def _characters(report: VerificationReport) -> Table:
    runs = [*report.models, *report.shown]
    rows = [
        (f"{k + 1}" if run is runs[0] else "", run.name, f"{run.frequencies[0, k]:.2f}", run.characters[0][k])
        for k in range(report.count)
        for run in runs
    ]
    header = ("mode", "model", "frequency/Hz", "what moves (share of kinetic energy)")
    return Table(
        "What moves, " + _first_pose(report), header, tuple(rows), "Each model in the order of its frequencies."
    )


def _curve(report: VerificationReport) -> tuple[Table, ...]:
    """Error against the number of coordinates, over all poses, each reduction against its own complete model."""
    runs = [run for run in report.reductions if run.name in report.curve]
    runs = [run for run in runs if any(run.own == model.name for model in report.models)]
    if not runs:
        return ()
    rows = []
    for run in runs:
        each = report.comparison(run.name, run.own)
        figures = f"{1e2 * _rms(each.rms):.3f}", f"{1e2 * each.largest.max():.3f}", f"{each.mac_diagonal.min():.4f}"
        rows.append((run.family, str(run.modes_per_part), str(run.size), run.own, *figures))
    header = ("reduction", "modes per part", "coordinates", "against", "RMS/%", "largest/%", "least MAC")
    return (Table("Error against the number of coordinates, all poses", header, tuple(rows)),)


def pose_texts(report: VerificationReport) -> tuple[str, ...]:
    """Every pose in words."""
    return tuple(pose_text(pose, report.coordinates) or "the only pose" for pose in report.poses)


def _first_pose(report: VerificationReport) -> str:
    return f"at {pose_texts(report)[0]}"


def _close_modes(clusters: Sequence[int] | FloatArray) -> str:
    """A sentence about modes that cannot be told apart."""
    labels = list(clusters)
    close = [[k + 1 for k, each in enumerate(labels) if each == label] for label in dict.fromkeys(labels)]
    named = ["-".join((str(some[0]), str(some[-1]))) for some in close if len(some) > 1]
    if not named:
        return ""
    return (
        f"Modes {', '.join(named)} are too close to be told apart: any combination of them is a mode as well. They are "
        "turned to match before the MAC is taken."
    )


def _pose_seconds(run: ModelRun) -> float:
    return run.further_seconds if run.further_seconds is not None else float(run.seconds[0])


def _rms(values: FloatArray) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _seconds(value: float | None) -> str:
    return "" if value is None else f"{value:.3g}"
