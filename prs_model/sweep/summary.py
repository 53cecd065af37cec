"""A map in short, as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from ..description.units import SI
from .drawn.panels import extreme

if TYPE_CHECKING:
    import xarray

    from ..machine import Machine


def summary(machine: Machine, data: xarray.Dataset) -> dict[str, Any]:
    """What a map says in short: the extremes of every mode and where, unreachable poses by reason, the certificate."""
    kinds = machine.kinematics.task.coordinates
    frequency = data["frequency"].transpose("mode", ...)
    reason = data["reason"]
    sentences = dict(zip(reason.attrs["flag_values"].tolist(), _sentences(reason.attrs), strict=True))
    counts = dict(zip(*(each.tolist() for each in np.unique(reason.values, return_counts=True)), strict=True))
    reachable = counts.get(0, 0) > 0
    return {
        "machine": machine.name,
        "poses": int(reason.size),
        "pose_units": {name: kind.label(SI) for name, kind in kinds.items()},
        "quantities": data.attrs["quantities"].split(),
        "modes": [_extremes(frequency[k], machine.pose_names) for k in range(len(frequency))] if reachable else [],
        "unreachable": [{"reason": sentences[code], "poses": number} for code, number in counts.items() if code != 0],
        "certificate": {
            name.removeprefix("certificate_"): value
            for name, value in data.attrs.items()
            if name.startswith("certificate_")
        },
    }


def _sentences(flags: Mapping[str, str]) -> list[str]:
    return [each.split(": ", 1)[1] for each in flags["flag_sentences"].split("; ")]


def _extremes(frequency: xarray.DataArray, names: tuple[str, ...]) -> dict[str, Any]:
    values = frequency.values
    low, high = extreme(values, -1), extreme(values, 1)

    def at(place: Any) -> dict[str, float]:
        there = frequency[place]
        return {name: float(there[name]) for name in names}

    return {
        "number": int(frequency["mode"]),
        "lowest_hz": float(values[low]),
        "lowest_at": at(low),
        "highest_hz": float(values[high]),
        "highest_at": at(high),
        "median_hz": float(np.nanmedian(values)),
    }
