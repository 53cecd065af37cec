"""A verification as plain data for JSON: SI units, shares instead of per cent."""

from __future__ import annotations

from typing import Any

from ..description.units import SI
from .report import Comparison, ModelRun, VerificationReport


def as_dict(report: VerificationReport) -> dict[str, Any]:
    """Everything in a report but the shapes of the modes; MAC matrices for the reductions that tables show."""
    return {
        "machine": report.machine,
        "title": report.title,
        "joint_stiffness": report.joint_stiffness,
        "count": report.count,
        "environment": report.environment,
        "published_hz": {name: list(each) for name, each in report.published.items()},
        "poses": [{name: float(value) for name, value in pose.items()} for pose in report.poses],
        "pose_units": {name: kind.label(SI) for name, kind in report.coordinates.items()},
        "models": [_run(run) | _complete(run) for run in report.models],
        "reductions": [_run(run) | _reduced(report, run) for run in report.reductions],
        "comparisons": [_comparison(each, whole=each.reduction not in report.curve) for each in report.comparisons],
    }


def _run(run: ModelRun) -> dict[str, Any]:
    return {
        "name": run.name,
        "title": run.title,
        "coordinates": run.size,
        "modes_per_part": run.modes_per_part,
        "preparation_s": run.preparation,
        "seconds": run.seconds.tolist(),
        "frequencies_hz": run.frequencies.tolist(),
        "characters": [list(each) for each in run.characters],
    }


def _complete(run: ModelRun) -> dict[str, Any]:
    return {
        "residuals": None if run.residuals is None else run.residuals.tolist(),
        "peak_memory_bytes": run.peak_memory,
    }


def _reduced(report: VerificationReport, run: ModelRun) -> dict[str, Any]:
    return {
        "against": run.own,
        "least_margin": report.least_margin(run),
        "least_margin_in_place": report.least_margin_in_place(run),
        "in_place_hz": None if run.in_place is None else run.in_place.tolist(),
        "in_curve": run.name in report.curve,
    }


def _comparison(each: Comparison, *, whole: bool) -> dict[str, Any]:
    found = {
        "reduction": each.reduction,
        "model": each.model,
        "partners": (each.partners + 1).tolist(),
        "clusters": each.clusters.tolist(),
        "discrepancies": each.discrepancies.tolist(),
        "margins": each.margins.tolist(),
        "rms": each.rms.tolist(),
        "largest": each.largest.tolist(),
        "mac_diagonal": each.mac_diagonal.tolist(),
    }
    return found | ({"mac": each.mac.round(6).tolist()} if whole else {})
