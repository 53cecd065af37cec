"""``prs-model reduce``: one part file to a checked super-element, with the figures its designer knows by heart."""

from __future__ import annotations

import argparse
from math import ceil, log10
from pathlib import Path
from typing import Any

from ..errors import PrsError
from ..readable import figure
from .table import table
from .values import add_assignments, nested, once, positive, value_of
from .wording import in_words_of_the_command

NAME = "reduce"
HELP = "read one part, reduce it to its interfaces, check it as physics, and store or export it"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The part, its interfaces, and where the result goes."""
    parser.add_argument("source", nargs="?", help="the part file (none for reducers that read no file)")
    parser.add_argument("--reducer", required=True, help="how it is read; `prs-model reducers` lists them")
    parser.add_argument(
        "-o", "--output", type=Path, metavar="FILE", help=".npz, or .op4, .pch, .mtx for other programs"
    )
    parser.add_argument("--units", help="of the part file, such as mm-N-tonne-s")
    parser.add_argument("--output-units", default="m-N-kg-s", metavar="UNITS", help="of the result (default m-N-kg-s)")
    add_assignments(
        parser,
        "--interface",
        "interface",
        "NAME=WHERE",
        "a node set or a node by name (tip=TIP), a node (tip=3), nodes (tip=[3, 11]), or as in machine.yaml, in "
        "SI (tip={box: {z: [0.3, 0.35]}})",
    )
    parser.add_argument("-n", "--count", type=positive, default=6, help="how many frequencies to show (default 6)")
    parser.add_argument("--modes", type=int, metavar="N", help="fixed-interface modes of a full model (default 3)")
    parser.add_argument(
        "--coupling", choices=("rigid", "averaged"), default="rigid", help="of interfaces (default rigid)"
    )
    parser.add_argument("--grounded", action="store_true", help="the part is held to the ground in its file")
    parser.add_argument("--clamp", action="append", default=[], metavar="SET", help="hold a node set to the ground")
    add_assignments(
        parser,
        "--expect",
        "expect",
        "NAME=VALUE",
        "what is known: mass=8.4 (kg), frequency=751 (Hz, the first), tolerance=0.05; else the part is refused",
    )
    add_assignments(
        parser,
        "--set",
        "settings",
        "OPTION=VALUE",
        "an option of the reducer, numbers in SI, such as material.E=2.1e11, or from a file: sections=@s.yaml; "
        "`prs-model reducers NAME` lists them",
    )


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Read, reduce, check, summarize, and write where asked."""
    with in_words_of_the_command(options.reducer):
        return _run(options)


def _run(options: argparse.Namespace) -> dict[str, Any]:
    from ..reduction import reduce
    from ..reduction.exports import check_writable, export
    from ..reduction.read_files import read_files
    from ..reduction.summary import reduced_here, summarize

    settings = nested("--set", options.settings)
    interfaces = {name: _where(name, text) for name, text in once("--interface", options.interface).items()}
    _check_source(options)
    kept: tuple[Path, ...] = ()
    if options.output is not None:
        kept = read_files(options.reducer, options.source, units=options.units, options=settings)
        check_writable(options.output, units=options.output_units, keep=kept)
    element = reduce(
        options.reducer,
        options.source,
        interfaces=interfaces,
        units=options.units,
        modes=options.modes,
        coupling=options.coupling,
        grounded=options.grounded or bool(options.clamp),
        clamped=options.clamp,
        expected=nested("--expect", options.expect) or None,
        options=settings,
    )
    report, summary = element.check(), summarize(element, options.count)
    if options.output is not None:
        export(element, options.output, units=options.output_units, keep=kept)
    return {
        **summary.as_dict(),
        "reduced_here": reduced_here(element),
        "reducer": options.reducer,
        "source": options.source,
        "units": options.units,
        "gate": [{"check": each.name, "figure": each.figure, "limit": each.limit} for each in report.checks],
        "output": None if options.output is None else str(options.output),
    }


def _check_source(options: argparse.Namespace) -> None:
    from ..plugins import reducer

    if options.source is None and reducer(options.reducer).needs_source:
        raise PrsError(f"reducer '{options.reducer}' reads a part file: name it, prs-model reduce FILE ..")


def show(outcome: dict[str, Any]) -> str:
    """The summary in words and tables."""
    said = f", file in {outcome['units']}" if outcome["units"] else ""
    source = f"{outcome['source']}, " if outcome["source"] else ""
    lines = [f"{outcome['name']} ({source}reducer {outcome['reducer']}{said})", "", table(_figures(outcome)), ""]
    lines += [table([("node", "x/m", "y/m", "z/m"), *_places(outcome["nodes_m"])]), ""]
    checks = [("physics gate: passed", "figure", "allowed")]
    checks += [(each["check"], f"{each['figure']:.1e}", f"{each['limit']:.0e}") for each in outcome["gate"]]
    lines += [table(checks), *(f"surprising: {each}" for each in outcome["surprises"])]
    if outcome["output"]:
        lines += ["", f"written to {outcome['output']}"]
    return "\n".join(lines)


def _figures(outcome: dict[str, Any]) -> list[tuple[str, str]]:
    physical = outcome["coordinates"] - outcome["modes"]
    rows = [("coordinates", f"{outcome['coordinates']} ({physical} of nodes, {outcome['modes']} modal)")]
    if outcome["grounded"]:
        rows += [("held", "to the ground: rigid motion costs energy, the mass is partly in the ground")]
    else:
        reach, inertia = _reach(outcome), outcome["inertia_kg_m2"]
        rows += [("mass/kg", figure(outcome["mass_kg"], 6)), ("centre/m", _vector(outcome["centre_m"], reach))]
        least = max(*map(max, inertia), outcome["mass_kg"] * reach**2)
        moments = [_vector(row, least) for row in inertia]
        rows += [(f"inertia/(kg m^2) {axis}", moment) for axis, moment in zip("xyz", moments, strict=True)]
    rows += [("size/m" if outcome["size_of"] == "part" else "nodes within/m", _vector(outcome["size_m"]))]
    rows += [("nodes held/Hz", _vector(outcome["fixed_frequencies_hz"]))]
    rows += [("as it is/Hz" if outcome["grounded"] else "free/Hz", _vector(outcome["free_frequencies_hz"]))]
    if outcome["reduced_here"]:
        rows += [
            ("", "of the reduced part: few modes (--modes) and rigid interfaces raise them above what its solver says")
        ]
    return rows


def _reach(outcome: dict[str, Any]) -> float:
    """The longest of its lengths [m]."""
    return float(max([*outcome["size_m"], *(abs(x) for place in outcome["nodes_m"].values() for x in place)]))


def _places(nodes: dict[str, list[float]]) -> list[tuple[str, ...]]:
    """Rows of names and coordinates, all with as many decimals as show five digits of the longest."""
    longest = max((abs(x) for place in nodes.values() for x in place), default=0.0)
    digits = min(max(4 - ceil(log10(longest)) + 1, 4), 12) if longest > 0.0 else 4
    return [
        (name, *(f"{round(x, digits) + 0.0:>{digits + 6}.{digits}f}" for x in place)) for name, place in nodes.items()
    ]


def _vector(values: list[float], size: float = 0.0) -> str:
    """Numbers to six digits, those that are round-off beside the others (or `size`) as zero."""
    least = 1e-9 * max([abs(value) for value in values] + [size])
    return "  ".join(figure(value if abs(value) > least else 0.0, 6) for value in values) or "none"


def _where(name: str, text: str) -> Any:
    """An interface as `reduce` takes it."""
    value = value_of("--interface", name, text)
    if value in (None, "") or isinstance(value, bool | float):
        expected = "a node set or a node by its name, a node, [nodes] or {box: ..}"
        raise PrsError(f"--interface {name}: found '{text}', expected {expected}")
    return value
