"""``prs-model frf``: frequency responses at one pose, at the tool or between two nodes."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError
from . import damping_argument, frf_text, machine_argument, pose_argument
from .output_argument import add_outputs
from .values import positive

if TYPE_CHECKING:
    from ..description.schema import Damping
    from ..modes import Modes
    from ..response import FrequencyResponse
    from ..synthesis import System

NAME = "frf"
HELP = "frequency responses, static compliance, where it comes from, and weak modes at one pose"

show = frf_text.show

_MOST = 1_000_000
_NONE = 1e-12  # of the largest part of a mode in a response: round-off


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The machine, the pose, what is asked of it, and where it goes."""
    pose_argument.add_machine_and_pose(parser)
    parser.add_argument(
        "--range",
        metavar="FIRST:LAST:COUNT",
        help="frequencies in Hz, such as 10:500:2000; default: from a tenth of the first mode to beyond the eighth, "
        "closer round each mode",
    )
    node = "body.node, or output, which is the default"
    parser.add_argument("--from", dest="at", metavar="NODE", help=f"where the force acts: {node}")
    parser.add_argument("--to", metavar="NODE", help=f"where the response is read: {node}")
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
    add_outputs(parser, "write .csv, .uff (universal file, dataset 58), or a picture .png, .svg, .pdf")
    machine_argument.add_settings(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Solve, and write where asked."""
    from ..response.damping import damping_of, is_proportional
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
    model, every = damping_of(system, damping), system.modes(system.size)
    modes = every if options.count is None else system.modes(options.count)
    frequencies = _default_range(every, model) if given is None else given
    direct = options.direct or (len(modes.frequencies) < len(every.frequencies) and not is_proportional(model))
    ends = {"to": options.to, "at": options.at, "quantity": options.quantity}
    response = (system if direct else modes).frequency_response(frequencies, model, **ends)
    outcome = {
        **pose_argument.where(machine, configuration),
        **_what(response, model),
        "damping": damping if damping is not None else model.model_dump(mode="json", exclude_none=True),
        "method": "direct" if direct else "modal",
        "modes": None if direct else len(modes.frequencies),
        "frequencies_hz": response.frequencies.tolist(),
        "curves": [_curve(response, pair, _endless(every, model, response, pair)) for pair in pairs],
        **_static(system, every, response, pairs),
        "files": [str(file) for file in options.output],
    }
    title = f"{machine.description.file.title or machine.name}\n{frf_text.caption(outcome)}"
    for file in options.output:
        response.save(file, pairs, title)
    return outcome


def _what(response: FrequencyResponse, damping: Damping) -> dict[str, Any]:
    from ..response.damping import in_words

    return {
        "quantity": response.quantity,
        "to": response.to,
        "from": response.at,
        "damping_in_words": in_words(damping),
    }


def _curve(response: FrequencyResponse, pair: str, endless: float | None) -> dict[str, Any]:
    """One entry, its largest magnitude, and its least real part, by which regenerative chatter is judged.

    Without damping the magnitude has no end: `endless` is then the frequency [Hz] of the mode.
    """
    values = response.curve(pair)
    largest, least = int(np.argmax(np.abs(values))), int(np.argmin(values.real))
    row, column = pair.split("/")
    finite = endless is None
    return {
        "response": row,
        "excitation": column,
        "unit": response.unit(pair),
        "real": values.real.tolist(),
        "imag": values.imag.tolist(),
        "largest": float(np.abs(values[largest])) if finite else None,
        "largest_at_hz": float(response.frequencies[largest]) if finite else endless,
        "least_real": float(values.real[least]) if finite else None,
        "least_real_at_hz": float(response.frequencies[least]) if finite else endless,
    }


def _endless(modes: Modes, damping: Damping, response: FrequencyResponse, pair: str) -> float | None:
    """The frequency [Hz] of the undamped mode with most part in a response, of those in its range; None without."""
    from ..response.modal_equations import damping_ratios
    from ..response.points import point
    from ..response.quantity import DIRECTIONS

    low, high = response.frequencies.min(), response.frequencies.max()
    inside = (modes.frequencies >= low) & (modes.frequencies <= high)
    undamped = inside & (damping_ratios(modes, damping) == 0.0)
    row, column = (DIRECTIONS.index(each) for each in pair.split("/"))
    motions = [point(modes.system, name).motion @ modes.shapes for name in (response.to, response.at)]
    part = np.abs(motions[0][row] * motions[1][column])
    moved = undamped & (part > _NONE * part.max())
    return float(modes.frequencies[np.argmax(np.where(moved, part, 0.0))]) if moved.any() else None


def _static(system: System, modes: Modes, response: FrequencyResponse, pairs: list[str]) -> dict[str, Any]:
    """Compliance between the nodes; where it comes from and its weak modes, where they are one; none if it is free.

    Of weak modes those up to the highest frequency: far above them are the node's own surroundings giving way.
    """
    from ..response.quantity import DIRECTIONS

    nothing: dict[str, Any] = {
        "static_compliance": None,
        "static_energy": {},
        "static_energy_by_kind": {},
        "weak_modes": [],
    }
    if modes.is_rigid.any():
        return nothing
    compliance = system.static_compliance(response.to, response.at).tolist()
    if response.to != response.at:
        return {**nothing, "static_compliance": compliance}
    energy = system.static_energy(response.at)
    asked = [row for row, column in (pair.split("/") for pair in pairs) if row == column]
    shown = system.modes(max(1, int(np.sum(modes.frequencies <= response.frequencies.max()))))
    return {
        "static_compliance": compliance,
        "static_energy": {
            each: {name: float(share[DIRECTIONS.index(each)]) for name, share in energy.items()} for each in asked
        },
        "static_energy_by_kind": {each: _by_kind(system, energy, DIRECTIONS.index(each)) for each in asked},
        "weak_modes": [str(mode) for mode in shown.weak_modes(response.at) if mode.direction in asked],
    }


def _by_kind(system: System, energy: dict[str, FloatArray], axis: int) -> dict[str, float]:
    from ..modes import shares_by_group

    return shares_by_group({name: float(share[axis]) for name, share in energy.items()}, system.stems)


def _range(text: str) -> FloatArray:
    """Frequencies (f,) [Hz] of ``first:last:count``. Raises PrsError."""
    pieces = text.split(":")
    if len(pieces) != 3:
        raise _wrong_range(text, f"has {len(pieces)} part{'s' if len(pieces) > 1 else ''}, not three")
    first, last = (_frequency(text, *each) for each in zip(("first", "last"), pieces[:2], strict=True))
    if last <= first:
        raise _wrong_range(text, f"the last, {last:g} Hz, is not above the first, {first:g} Hz")
    if not pieces[2].strip().isdecimal() or not 2 <= int(pieces[2]) <= _MOST:
        raise _wrong_range(text, f"the count is '{pieces[2]}', not a whole number from 2 to {_MOST}")
    return np.linspace(first, last, int(pieces[2]))


def _frequency(text: str, which: str, piece: str) -> float:
    try:
        value = float(piece)
    except ValueError:
        value = np.nan
    if not 0.0 < value < np.inf:
        raise _wrong_range(text, f"the {which} is '{piece}', not a frequency above zero")
    return value


def _wrong_range(text: str, what: str) -> PrsError:
    return PrsError(f"--range: found '{text}', expected first:last:count in Hz, such as 10:500:2000; {what}")


def _default_range(modes: Modes, damping: Damping) -> FloatArray:
    from ..response.band import band
    from ..response.modal_equations import damping_ratios

    count = max(1, 8 - int(modes.is_rigid.sum()))
    frequencies = band(modes, damping_ratios(modes, damping), count)
    if not frequencies.size:
        raise PrsError("--range: all modes are at 0 Hz; say which frequencies, such as 10:500:2000")
    return frequencies
