"""``prs-model frf``: frequency responses at one pose, at the tool or between two nodes."""

from __future__ import annotations

import argparse
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError
from ..readable import figure
from . import damping_argument, machine_argument, pose_argument
from .table import table
from .values import positive

if TYPE_CHECKING:
    from ..modes import Modes
    from ..response import FrequencyResponse
    from ..synthesis import System

NAME = "frf"
HELP = "frequency responses, static compliance and weak modes at one pose"

_LINES = 1000
_MOST = 1_000_000


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The machine, the pose, what is asked of it, and where it goes."""
    pose_argument.add_machine_and_pose(parser)
    parser.add_argument(
        "--range",
        metavar="FIRST:LAST:COUNT",
        help="frequencies in Hz, such as 10:500:2000; default: from a tenth of the first mode to beyond the eighth",
    )
    parser.add_argument("--from", dest="at", metavar="NODE", help="body.node of the force; default: the output")
    parser.add_argument("--to", metavar="NODE", help="body.node of the response; default: the output")
    parser.add_argument(
        "--direction",
        nargs="+",
        default=["u", "v", "w"],
        metavar="AXIS",
        help="of u, v, w, ru, rv, rw of the output frame, or response/excitation such as w/u (default u v w)",
    )
    parser.add_argument(
        "--quantity",
        choices=("receptance", "mobility", "accelerance"),
        default="receptance",
        help="displacement, velocity or acceleration per force (default receptance)",
    )
    damping_argument.add_damping(parser)
    way = parser.add_mutually_exclusive_group()
    way.add_argument("--direct", action="store_true", help="solve for each frequency instead of adding up modes")
    way.add_argument("-n", "--count", type=positive, help="how many modes, static correction added; default: all")
    parser.add_argument(
        "-o",
        "--output",
        nargs="+",
        action="extend",
        type=Path,
        default=[],
        metavar="FILE",
        help="write .csv, .uff (universal file, dataset 58), or a picture .png, .svg, .pdf",
    )
    machine_argument.add_settings(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Solve, and write where asked."""
    from ..response.files import check_file
    from ..response.quantity import pair_of

    pairs = ["/".join(pair_of(text)) for text in options.direction]
    given = None if options.range is None else _range(options.range)
    damping = damping_argument.damping_of(options)
    for file in options.output:
        check_file(file)
    machine = machine_argument.changed(options)
    configuration = pose_argument.configuration_at(machine, options)
    system = machine.assemble(configuration)
    modes = system.modes(system.size if options.count is None else options.count)
    frequencies = _default_range(system) if given is None else given
    ends = {"to": options.to, "at": options.at, "quantity": options.quantity}
    model = system if options.direct else modes
    response = model.frequency_response(frequencies, damping, **ends)
    outcome = pose_argument.where(machine, configuration)
    for file in options.output:
        response.save(file, pairs, f"{machine.description.file.title or machine.name}\n{_what(response)}")
    return {
        **outcome,
        "quantity": response.quantity,
        "to": response.to,
        "from": response.at,
        "damping": damping if damping is not None else system.damping_model.model_dump(mode="json", exclude_none=True),
        "method": "direct" if options.direct else "modal",
        "modes": None if options.direct else len(modes.frequencies),
        "frequencies_hz": response.frequencies.tolist(),
        "curves": [_curve(response, pair) for pair in pairs],
        **_static(system, _up_to(modes, float(response.frequencies.max())), options),
        "files": [str(file) for file in options.output],
    }


def show(outcome: dict[str, Any]) -> str:
    """A table of the largest responses under a line that says where, then the weak modes."""
    low, high = min(outcome["frequencies_hz"]), max(outcome["frequencies_hz"])
    way = f"{outcome['modes']} modes" if outcome["method"] == "modal" else "solved directly"
    what = f"{outcome['quantity']} at {outcome['to']} by a force at {outcome['from']}"
    lines = [f"{pose_argument.heading(outcome)}: {what}, {low:g} .. {high:g} Hz ({way})", ""]
    rows = [("response/force", "largest", "at/Hz", "unit")]
    for curve in outcome["curves"]:
        rows.append((_name(curve), f"{curve['largest']:.4g}", f"{curve['largest_at_hz']:.2f}", curve["unit"]))
    lines.append(table(rows))
    if outcome["static_compliance"] is None:
        lines += ["", "no static compliance: the machine can move without straining anything"]
    else:
        lines += ["", "at rest:", table(_static_rows(outcome))]
    lines += ["", *outcome["weak_modes"]] if outcome["weak_modes"] else []
    return "\n".join([*lines, *(f"written to {file}" for file in outcome["files"])])


def _what(response: FrequencyResponse) -> str:
    return f"{response.quantity} at {response.to} by a force at {response.at}"


def _curve(response: FrequencyResponse, pair: str) -> dict[str, Any]:
    values = response.curve(pair)
    largest = int(np.argmax(np.abs(values)))
    row, column = pair.split("/")
    return {
        "response": row,
        "excitation": column,
        "unit": response.unit(pair),
        "real": values.real.tolist(),
        "imag": values.imag.tolist(),
        "largest": float(np.abs(values[largest])),
        "largest_at_hz": float(response.frequencies[largest]),
    }


def _static(system: System, modes: Modes, options: argparse.Namespace) -> dict[str, Any]:
    """Compliance between the nodes, and the weak ones of the modes where both are the output; none if it is free."""
    if system.modes(1).is_rigid.any():
        return {"static_compliance": None, "weak_modes": []}
    weak = modes.weak_modes() if options.to is None and options.at is None else ()
    compliance = system.static_compliance(options.to, options.at)
    return {"static_compliance": compliance.tolist(), "weak_modes": [str(mode) for mode in weak]}


def _up_to(modes: Modes, frequency: float) -> Modes:
    """The modes up to a frequency, at least one: those far above are the node's own surroundings giving way."""
    count = max(1, int(np.sum(modes.frequencies <= frequency)))
    return replace(modes, eigenvalues=modes.eigenvalues[:count], shapes=modes.shapes[:, :count])


def _static_rows(outcome: dict[str, Any]) -> list[tuple[str, ...]]:
    from ..response.quantity import DIRECTIONS, unit

    rows: list[tuple[str, ...]] = [("response/force", "compliance", "unit")]
    for curve in outcome["curves"]:
        row, column = curve["response"], curve["excitation"]
        value = outcome["static_compliance"][DIRECTIONS.index(row)][DIRECTIONS.index(column)]
        stiffness = f"{figure(1e-6 / value)} N/um" if row == column and row in "uvw" and value > 0.0 else ""
        rows.append((_name(curve), f"{value:.4g}", f"{unit(row, column)}", stiffness))
    return [rows[0] + ("stiffness",), *rows[1:]]


def _name(curve: dict[str, Any]) -> str:
    row, column = curve["response"], curve["excitation"]
    return row if row == column else f"{row}/{column}"


def _range(text: str) -> FloatArray:
    """Frequencies (f,) [Hz] of ``first:last:count``. Raises PrsError."""
    pieces = text.split(":")
    try:
        first, last, count = float(pieces[0]), float(pieces[1]), int(pieces[2])
    except (ValueError, IndexError):
        first, last, count = 0.0, 0.0, 0
    if len(pieces) != 3 or not 0.0 < first < last < np.inf or not 2 <= count <= _MOST:
        raise PrsError(
            f"--range: found '{text}', expected first:last:count in Hz, such as 10:500:2000, the first above zero and "
            "below the last"
        )
    return np.linspace(first, last, count)


def _default_range(system: System) -> FloatArray:
    frequencies = system.modes(8).frequencies
    elastic = frequencies[frequencies > 0.0]
    if not elastic.size:
        raise PrsError("--range: the first modes are all at 0 Hz; say which frequencies, such as 10:500:2000")
    return np.linspace(0.1 * elastic[0], 1.25 * elastic[-1], _LINES)
