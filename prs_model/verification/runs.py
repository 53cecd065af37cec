"""One model solved at all poses: the complete order, or a reduction of it."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError
from ..kinematics import Configuration
from ..machine import Machine
from ..modes import Modes
from ..modes.mac import Observation, observe
from ..readable import pose_text
from ..synthesis import System, assemble
from .in_place import InPlace
from .reductions import COUPLINGS, TITLES, Reduction
from .report import ModelRun

EXTRA = 4  # modes beyond those asked for, so that pairs and clusters at the end are not cut

logger = logging.getLogger("prs_model")


@dataclass(frozen=True, eq=False)
class Observed:
    """A run with the shapes of its modes at every pose."""

    run: ModelRun
    shapes: Sequence[Observation]


def complete_run(
    machine: Machine, name: str, configurations: Sequence[Configuration], count: int, cache: Path | None
) -> Observed:
    """The complete order "A" or "B". Times are those of solving, earlier if a pose is in the cache."""
    logger.info("%s: %s", name, TITLES[name])
    order = machine.complete_order(COUPLINGS[name], cache=None if cache is None else cache / "complete_order")
    solved = []

    def solve(configuration: Configuration) -> Modes:
        solved.append(order.modes(configuration, count + EXTRA))
        return solved[-1].modes

    poses = _over_poses(machine, name, solve, configurations)
    seconds = np.array([each.seconds for each in solved])
    run = ModelRun(
        name=name,
        title=TITLES[name],
        own=name,
        size=solved[0].size,
        frequencies=poses.frequencies,
        characters=poses.characters,
        seconds=seconds,
        preparation=0.0,
        reference_modes=poses.first,
        residuals=np.array([each.residuals for each in solved]),
        peak_memory=peak_memory() if np.all(poses.seconds > 0.9 * seconds) else None,
    )
    return Observed(run, poses.shapes)


def reduced_run(
    machine: Machine, reduction: Reduction, configurations: Sequence[Configuration], count: int, *, in_place: bool
) -> Observed:
    """A machine whose parts are reduced in one way; in_place: also with travelling contacts reduced where they are.

    Raises PrsError when it has fewer coordinates than modes are asked for.
    """
    logger.info("%s: %s", reduction.name, reduction.title)

    def system(configuration: Configuration) -> System:
        return assemble(machine.description, machine.parts, machine.joints, configuration)

    start = perf_counter()
    size = system(configurations[0]).size
    preparation = perf_counter() - start
    if size < count:
        raise PrsError(f"{reduction.name}: found {size} coordinates, expected {count} at least; compare fewer modes")
    most = min(size, count + EXTRA)
    poses = _over_poses(machine, reduction.name, lambda each: system(each).modes(most), configurations)
    run = ModelRun(
        name=reduction.name,
        title=reduction.title,
        own=reduction.own,
        size=size,
        frequencies=poses.frequencies,
        characters=poses.characters,
        seconds=poses.seconds,
        preparation=preparation,
        reference_modes=poses.first,
        family=reduction.family,
        modes_per_part=reduction.modes,
        in_place=_in_place(machine, reduction.name, configurations, count) if in_place else None,
    )
    return Observed(run, poses.shapes)


def peak_memory() -> float | None:
    """The most memory [bytes] this process has held until now; None where the system does not say."""
    try:
        import resource
    except ImportError:  # Windows
        return None
    unit = 1.0 if sys.platform == "darwin" else 1024.0
    return unit * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _in_place(machine: Machine, name: str, configurations: Sequence[Configuration], count: int) -> FloatArray | None:
    """Frequencies (poses, count) without interpolation between stations; None for a machine that has no stations."""
    parts = InPlace(machine)
    if not parts.travelling:
        return None
    frequencies = []
    for k, configuration in enumerate(configurations):
        logger.info("%s: pose %d of %d, contacts reduced in place", name, k + 1, len(configurations))
        system = assemble(machine.description, parts.at(configuration), machine.joints, configuration)
        frequencies.append(system.modes(count).frequencies)
    return np.array(frequencies)


@dataclass(frozen=True, eq=False)
class _Poses:
    """What tables and comparisons need of the modes at every pose; `first` are those at the first one."""

    first: Modes
    frequencies: FloatArray
    characters: tuple[tuple[str, ...], ...]
    shapes: list[Observation]
    seconds: FloatArray


def _over_poses(
    machine: Machine,
    name: str,
    solve: Callable[[Configuration], Modes],
    configurations: Sequence[Configuration],
) -> _Poses:
    first: list[Modes] = []
    frequencies, characters, shapes, seconds = [], [], [], []
    for k, configuration in enumerate(configurations):
        place = pose_text(configuration.pose, machine.kinematics.task.coordinates) or "its only pose"
        logger.info("%s: pose %d of %d, %s", name, k + 1, len(configurations), place)
        start = perf_counter()
        modes = solve(configuration)
        seconds.append(perf_counter() - start)
        frequencies.append(modes.frequencies)
        characters.append(tuple(map(str, modes.characters())))
        shapes.append(observe(modes))
        first = first or [modes]
    return _Poses(first[0], np.array(frequencies), tuple(characters), shapes, np.array(seconds))
