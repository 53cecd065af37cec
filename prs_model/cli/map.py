"""``prs-model map``: frequencies, and what comes with them, over the whole workspace."""

from __future__ import annotations

import argparse
from collections.abc import Iterator, Mapping
from pathlib import Path
from time import perf_counter
from typing import Any

from ..machine import Machine
from ..readable import pose_text
from ..sweep.poses import Poses, poses_of
from ..sweep.request import QUANTITIES, Request
from . import machine_argument, pose_argument
from .grids import grid_from
from .output_argument import add_outputs
from .pose_list import poses_from_file
from .progress import bar
from .table import table
from .values import assignment, dimension_of, positive

NAME = "map"
HELP = "natural frequencies, compliance and tracked modes over the workspace, each frequency with a bound"

_PROVED = {
    "poses_interpolated": "interpolated, their bounds estimated, no mode missing by a count (proof 1)",
    "poses_solved": "solved in full (proof 2)",
    "poses_bounded": "enclosed from both sides, no mode missing by a count (proof 3)",
    "poses_unreachable": "out of reach",
}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The machine, the poses, what is asked of them, and where it goes."""
    pose_argument.add_machine(parser)
    which = parser.add_mutually_exclusive_group(required=True)
    which.add_argument(
        "--grid",
        nargs="+",
        action="extend",
        type=assignment,
        metavar="NAME=VALUES",
        help="every combination of such as nutation=0:30deg:100 precession=0:360deg:3600 z=1275mm; both ends of a "
        "range are among its values; coordinates left out stand at the reference pose",
    )
    which.add_argument(
        "--poses", type=Path, metavar="FILE.csv", help="a list, a column each coordinate: nutation [deg]"
    )
    parser.add_argument("-n", "--count", type=positive, default=6, help="how many modes (default 6)")
    parser.add_argument(
        "--quantity",
        nargs="+",
        action="extend",
        default=[],
        metavar="NAME",
        help=f"beside frequencies: {', '.join(name for name in QUANTITIES if name != 'frequency')}",
    )
    parser.add_argument("--band", nargs=2, type=float, metavar=("LOW", "HIGH"), help="of frf_peak, in Hz")
    parser.add_argument(
        "--tolerance", type=float, default=1e-6, help="relative, of every frequency (default 1e-6)", metavar="SHARE"
    )
    add_outputs(parser, "write .nc, .zarr, .csv, or a picture .png, .svg, .pdf")
    parser.add_argument("--draw", default="frequency", metavar="NAME", help="what a picture shows (default frequency)")
    parser.add_argument(
        "--store",
        type=Path,
        metavar="DIR",
        help="keep finished pieces there, and go on from them after an interruption",
    )
    parser.add_argument(
        "--cluster", metavar="ADDRESS", help="compute on the workers of this Dask scheduler, such as tcp://host:8786"
    )
    machine_argument.add_settings(parser)


def run(options: argparse.Namespace) -> dict[str, Any]:
    """Sweep the workspace, and write where asked."""
    from ..sweep.drawn.picture import check_drawing
    from ..sweep.files import PICTURES, check_file, save
    from ..sweep.run import sweep
    from ..sweep.summary import summary

    band = None if options.band is None else tuple(options.band)
    request = Request(options.count, ("frequency", *options.quantity), options.tolerance, band)
    for file in options.output:
        check_file(file)
    machine = machine_argument.changed(options)
    poses = _poses(machine, options)
    if any(file.suffix.lower() in PICTURES for file in options.output):
        check_drawing(options.draw, request.quantities, poses.size)
    start = perf_counter()
    with bar(quiet=options.quiet, unit="poses") as progress:
        data = sweep(machine, poses, request, progress, options.store, options.cluster)
    seconds = perf_counter() - start
    for file in options.output:
        save(data, file, options.draw)
    return {**summary(machine, data), "seconds": seconds, "files": [str(file) for file in options.output]}


def show(outcome: dict[str, Any]) -> str:
    """A table of the modes: how low and how high they go, and where; what could not be reached, and what was proved."""
    kinds = {name: dimension_of(unit) for name, unit in outcome["pose_units"].items()}
    rows = [("mode", "lowest/Hz", "at", "highest/Hz", "median/Hz")]
    for mode in outcome["modes"]:
        where = pose_text(mode["lowest_at"], kinds)
        low, high, middle = (f"{mode[f'{which}_hz']:.3f}" for which in ("lowest", "highest", "median"))
        rows.append((str(mode["number"]), low, where, high, middle))
    rate = outcome["poses"] / max(outcome["seconds"], 1e-9)
    title = f"{outcome['machine']}: {outcome['poses']:,} poses in {outcome['seconds']:.2f} s ({rate:,.0f} a second)"
    lines = [title, "", table(rows) if outcome["modes"] else "no pose is reachable"]
    lines += [f"{_poses_in_words(each['poses'])}: {each['reason']}" for each in outcome["unreachable"]]
    lines += ["", *_certificate(outcome["certificate"])]
    return "\n".join([*lines, *(f"written to {file}" for file in outcome["files"])])


def _certificate(certificate: Mapping[str, Any]) -> Iterator[str]:
    """In the words of the table of `proof` in docs/maps.md."""
    yield f"how: {certificate['how']}"
    for name, words in _PROVED.items():
        if certificate[name]:
            yield f"{_poses_in_words(certificate[name])} {words}"
    if "relative_error_bound" in certificate:
        yield f"largest bound of a relative error: {certificate['relative_error_bound']:.2g}"


def _poses_in_words(count: int) -> str:
    return f"{count:,} {'pose' if count == 1 else 'poses'}"


def _poses(machine: Machine, options: argparse.Namespace) -> Poses:
    if options.poses is not None:
        return poses_of(machine, {}, poses_from_file(options.poses, machine))
    return poses_of(machine, grid_from(options.grid, machine.kinematics.task.coordinates))
