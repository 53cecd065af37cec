"""``prs-model reduce``: one part file to a checked super-element, with the figures its designer knows by heart."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from ..description import parse_value
from ..errors import PrsError
from .table import table
from .values import assignment

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
    parser.add_argument(
        "--interface",
        action="append",
        type=assignment,
        default=[],
        metavar="NAME=WHERE",
        help="a node set (tip=TIP), a node (tip=3), nodes (tip=[3, 11]), or as in machine.yaml, in SI "
        "(tip={box: {z: [0.3, 0.35]}}); may be repeated",
    )
    parser.add_argument("--modes", type=int, metavar="N", help="fixed-interface modes of a full model (default 3)")
    parser.add_argument(
        "--coupling", choices=("rigid", "averaged"), default="rigid", help="of interfaces (default rigid)"
    )
    parser.add_argument("--grounded", action="store_true", help="the part is held to the ground in its file")
    parser.add_argument("--clamp", action="append", default=[], metavar="SET", help="hold a node set to the ground")
    parser.add_argument(
        "--expect",
        action="append",
        type=assignment,
        default=[],
        metavar="NAME=VALUE",
        help="what is known: mass=8.4 (kg), frequency=751 (Hz, the first), tolerance=0.05; else the part is refused",
    )
    parser.add_argument(
        "--set",
        dest="settings",
        action="append",
        type=assignment,
        default=[],
        metavar="OPTION=VALUE",
        help="an option of the reducer, numbers in SI, such as material.E=2.1e11 (may be repeated)",
    )


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Read, reduce, check, summarize, and write where asked."""
    from ..reduction import reduce
    from ..reduction.exports import check_writable, export
    from ..reduction.summary import summarize

    if options.output is not None:
        check_writable(options.output)
    element = reduce(
        options.reducer,
        options.source,
        interfaces={name: _where(name, text) for name, text in _once("--interface", options.interface).items()},
        units=options.units,
        modes=options.modes,
        coupling=options.coupling,
        grounded=options.grounded or bool(options.clamp),
        clamped=options.clamp,
        expected=_nested(_once("--expect", options.expect), "--expect") or None,
        **_nested(_once("--set", options.settings)),
    )
    report = element.check()
    if options.output is not None:
        export(element, options.output, units=options.output_units)
    return {
        **summarize(element).as_dict(),
        "reducer": options.reducer,
        "source": options.source,
        "units": options.units,
        "gate": [{"check": each.name, "figure": each.figure, "limit": each.limit} for each in report.checks],
        "output": None if options.output is None else str(options.output),
    }


def show(outcome: dict[str, Any]) -> str:
    """The summary in words and tables."""
    said = f", file in {outcome['units']}" if outcome["units"] else ""
    source = f"{outcome['source']}, " if outcome["source"] else ""
    lines = [f"{outcome['name']} ({source}reducer {outcome['reducer']}{said})", "", table(_figures(outcome)), ""]
    rows = [("node", "x/m", "y/m", "z/m")]
    rows += [(name, *(f"{x:>10.4f}" for x in place)) for name, place in outcome["nodes_m"].items()]
    lines += [table(rows), ""]
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
        size, inertia = max(outcome["size_m"]), outcome["inertia_kg_m2"]
        rows += [("mass/kg", f"{outcome['mass_kg']:.6g}"), ("centre/m", _vector(outcome["centre_m"], size))]
        moments = [_vector(row, max(map(max, inertia))) for row in inertia]
        rows += [(f"inertia/(kg m^2) {axis}", moment) for axis, moment in zip("xyz", moments, strict=True)]
    rows += [("size/m", _vector(outcome["size_m"]))]
    rows += [("nodes held/Hz", _vector(outcome["fixed_frequencies_hz"]))]
    rows += [("as it is/Hz" if outcome["grounded"] else "free/Hz", _vector(outcome["free_frequencies_hz"]))]
    return rows


def _vector(values: list[float], size: float = 0.0) -> str:
    """Numbers to six digits; those that are round-off beside the others (or `size`) as zero."""
    least = 1e-9 * max([abs(value) for value in values] + [size])
    return "  ".join(f"{value if abs(value) > least else 0.0:.6g}" for value in values) or "none"


def _where(name: str, text: str) -> dict[str, Any]:
    value = parse_value(text)
    if isinstance(value, dict):
        return value
    if isinstance(value, list | tuple):
        return {"nodes": value}
    if isinstance(value, int) and not isinstance(value, bool):
        return {"node": value}
    if isinstance(value, str) and value:
        return {"set": value}
    raise PrsError(f"--interface {name}: found '{text}', expected a node set, a node, [nodes] or {{box: ..}}")


def _once(option: str, assignments: list[tuple[str, str]]) -> dict[str, str]:
    given = dict(assignments)
    if len(given) < len(assignments):
        names = [name for name, _ in assignments]
        twice = next(name for name in names if names.count(name) > 1)
        raise PrsError(f"{option} {twice}: given twice")
    return given


def _nested(settings: dict[str, str], option: str = "--set") -> dict[str, Any]:
    """``{"material.E": "2.1e11"}`` as ``{"material": {"E": 2.1e11}}``."""
    options: dict[str, Any] = {}
    for path, text in settings.items():
        *sections, last = path.split(".")
        entry = options
        for section in sections:
            entry = entry.setdefault(section, {})
            if not isinstance(entry, dict):
                raise PrsError(f"{option} {path}: '{section}' has a value already, expected a section")
        if last in entry:
            raise PrsError(f"{option} {path}: '{last}' has a value already, or entries below it")
        entry[last] = parse_value(text)
    return options
