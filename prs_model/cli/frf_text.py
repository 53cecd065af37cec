"""What ``prs-model frf`` prints."""

from __future__ import annotations

from typing import Any

from ..readable import figure
from . import pose_argument
from .table import table


def show(outcome: dict[str, Any]) -> str:
    """A table of the largest responses under a line that says where; the compliance, its origin and the weak modes."""
    low, high = min(outcome["frequencies_hz"]), max(outcome["frequencies_hz"])
    way = f"{outcome['modes']} modes" if outcome["method"] == "modal" else "solved directly"
    heading = f"{pose_argument.heading(outcome)}: {_what(outcome)}, {figure(low)} .. {figure(high)} Hz"
    lines = [f"{heading} ({way}; {outcome['damping_in_words']})", "", table(_largest_rows(outcome))]
    if any(curve["largest"] is None for curve in outcome["curves"]):
        lines += ["without damping peaks have no end; say it with --damping, or in the description"]
    if outcome["static_compliance"] is None:
        lines += ["", "no static compliance: the machine can move without straining anything"]
    else:
        lines += ["", "at rest:", table(_static_rows(outcome))]
    if outcome["static_energy"]:
        lines += ["", "where the compliance comes from:", table(_energy_rows(outcome["static_energy_by_kind"]))]
    lines += ["", *outcome["weak_modes"]] if outcome["weak_modes"] else []
    return "\n".join([*lines, *(f"written to {file}" for file in outcome["files"])])


def caption(outcome: dict[str, Any]) -> str:
    """What a picture shows: pose, nodes, damping."""
    return f"{pose_argument.heading(outcome)}: {_what(outcome)}; {outcome['damping_in_words']}"


def _what(outcome: dict[str, Any]) -> str:
    return f"{outcome['quantity']} at {outcome['to']} by a force at {outcome['from']}"


def _largest_rows(outcome: dict[str, Any]) -> list[tuple[str, ...]]:
    """With the dynamic stiffness and the least real part of receptances at the node of the force, along its axis."""
    rows: list[tuple[str, ...]] = [
        ("response/force", "largest", "at/Hz", "unit", "dynamic stiffness", "least real part", "at/Hz")
    ]
    drives = outcome["quantity"] == "receptance" and outcome["to"] == outcome["from"]
    for curve in outcome["curves"]:
        cells = [_name(curve), _number(curve["largest"]), f"{curve['largest_at_hz']:.2f}", curve["unit"]]
        if drives and curve["response"] == curve["excitation"] and curve["largest"]:
            stiffness = f"{figure(1e-6 / curve['largest'])} N/um" if curve["response"] in "uvw" else ""
            cells += [stiffness, _number(curve["least_real"]), f"{curve['least_real_at_hz']:.2f}"]
        rows.append((*cells, "", "", "")[:7])
    return rows if any(row[4] or row[5] for row in rows[1:]) else [row[:4] for row in rows]


def _number(value: float | None) -> str:
    return "no end" if value is None else f"{value:.4g}"


def _static_rows(outcome: dict[str, Any]) -> list[tuple[str, ...]]:
    from ..response.quantity import DIRECTIONS, unit

    rows: list[tuple[str, ...]] = [("response/force", "compliance", "unit", "stiffness")]
    for curve in outcome["curves"]:
        row, column = curve["response"], curve["excitation"]
        value = outcome["static_compliance"][DIRECTIONS.index(row)][DIRECTIONS.index(column)]
        stiffness = f"{figure(1e-6 / value)} N/um" if row == column and row in "uvw" and value > 0.0 else ""
        rows.append((_name(curve), f"{value:.4g}", f"{unit(row, column)}", stiffness))
    return rows


def _energy_rows(shares: dict[str, dict[str, float]]) -> list[tuple[str, ...]]:
    """The kinds of bodies and joints with a tenth or more of the strain energy under the load, the largest first."""
    return [
        (each, ", ".join(f"{name} {share:.0%}" for name, share in kinds.items()) or "nothing is strained")
        for each, kinds in shares.items()
    ]


def _name(curve: dict[str, Any]) -> str:
    row, column = curve["response"], curve["excitation"]
    return row if row == column else f"{row}/{column}"
