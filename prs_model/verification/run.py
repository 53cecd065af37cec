"""Hold reduced models against the complete order, pose by pose."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError, UnknownNameError
from ..kinematics import Configuration
from ..machine import Machine
from ..modes import Modes
from ..modes.mac import Observation, in_common, observe, pairing
from ..readable import pose_text
from ..synthesis import System, assemble
from .full_parts import check_full_parts
from .poses import default_poses, distinct
from .reductions import COUPLINGS, REDUCTIONS, TITLES, Reduction
from .report import Comparison, ModelRun, VerificationReport

EXTRA = 4  # modes beyond those asked for, so that pairs and clusters at the end are not cut

logger = logging.getLogger("prs_model")


def verify(
    machine: Machine,
    poses: Sequence[Mapping[str, float]] | None = None,
    *,
    models: Sequence[str] = tuple(COUPLINGS),
    reductions: Sequence[Reduction] = REDUCTIONS,
    curve: Sequence[Reduction] = (),
    count: int = 8,
    cache: Path | None = None,
    joint_stiffness: float = 1.0,
) -> VerificationReport:
    """Compare the lowest `count` modes of reduced models with those of the complete order.

    poses: coordinate to value [m, rad], those left out at their reference; default: `default_poses`. models: "A" with
    interfaces averaged, "B" with rigid ones. curve: further reductions, for the curve of error against coordinates.
    cache: a folder that keeps reduced parts and solved poses. joint_stiffness: what the report shall say of the machine
    (see `with_joint_stiffness`).
    Raises PrsError or PartFileError when parts have no full matrices or too few coordinates, UnreachablePoseError.
    """
    check_full_parts(machine)
    wanted = _poses(machine, poses)
    configurations = [machine.configuration(**pose) for pose in wanted]
    variants = [(each, _stored_in(each.of(machine), cache)) for each in (*reductions, *curve)]
    complete = [_complete(machine, name, configurations, count, cache) for name in _known(models)]
    reduced = [_reduced(variant, each, configurations, count) for each, variant in variants]
    return VerificationReport(
        machine=machine.name,
        title=machine.description.file.title,
        poses=tuple(configuration.pose for configuration in configurations),
        coordinates=machine.kinematics.task.coordinates,
        count=count,
        models=tuple(each.run for each in complete),
        reductions=tuple(each.run for each in reduced),
        comparisons=tuple(compare(r, c, count) for r in reduced for c in complete),
        joint_stiffness=joint_stiffness,
        curve=tuple(each.name for each in curve),
    )


@dataclass(frozen=True, eq=False)
class Observed:
    """A run with the shapes of its modes at every pose."""

    run: ModelRun
    shapes: Sequence[Observation]


def compare(reduced: Observed, complete: Observed, count: int) -> Comparison:
    """Pair the modes of a reduced and a complete model at every pose; discrepancies of the lowest `count`."""
    pairs = []
    for k, (a, b) in enumerate(zip(complete.shapes, reduced.shapes, strict=True)):
        most = len(reduced.run.frequencies[k])
        shapes_a, shapes_b = in_common(a, b)
        pairs.append(
            pairing(shapes_a[:, :most], shapes_b, complete.run.frequencies[k][:most], reduced.run.frequencies[k])
        )
    partners = np.array([pair.partners[:count] for pair in pairs])
    there, here = complete.run.frequencies[:, :count], reduced.run.frequencies
    return Comparison(
        reduction=reduced.run.name,
        model=complete.run.name,
        partners=partners,
        clusters=np.array([pair.clusters[:count] for pair in pairs]),
        discrepancies=np.take_along_axis(here, partners, axis=1) / there - 1.0,
        margins=here[:, :count] / there - 1.0,
        mac=np.array([pair.mac[:count, :count] for pair in pairs]),
    )


def _poses(machine: Machine, poses: Sequence[Mapping[str, float]] | None) -> tuple[dict[str, float], ...]:
    if poses is None:
        return default_poses(machine)
    if not poses:
        raise PrsError("found no pose to verify at, expected one at least")
    return distinct([dict(machine.reference_pose) | dict(pose) for pose in poses])


def _known(models: Sequence[str]) -> tuple[str, ...]:
    for name in models:
        if name not in COUPLINGS:
            raise UnknownNameError("model", name, list(COUPLINGS))
    if not models:
        raise PrsError("found no model to verify against, expected A or B or both")
    return tuple(dict.fromkeys(models))


def _stored_in(machine: Machine, cache: Path | None) -> Machine:
    """The machine with its parts reduced anew, or kept in the cache; what is stored with the machine stays as it is."""
    return machine.replace({"reduction.store": None if cache is None else str(cache / "parts")})


def _complete(
    machine: Machine, name: str, configurations: Sequence[Configuration], count: int, cache: Path | None
) -> Observed:
    logger.info("%s: %s", name, TITLES[name])
    order = machine.complete_order(COUPLINGS[name])
    residuals, sizes = [], []

    def solve(configuration: Configuration) -> Modes:
        solved = order.modes(configuration, count + EXTRA)
        residuals.append(solved.residuals)
        sizes.append(solved.size)
        return solved.modes

    poses = _over_poses(machine, name, solve, configurations)
    run = ModelRun(
        name=name,
        title=TITLES[name],
        own=name,
        size=sizes[0],
        frequencies=poses.frequencies,
        characters=poses.characters,
        seconds=poses.seconds,
        preparation=0.0,
        reference_modes=poses.first,
        residuals=np.array(residuals),
        peak_memory=peak_memory(),
    )
    return Observed(run, poses.shapes)


def _reduced(machine: Machine, reduction: Reduction, configurations: Sequence[Configuration], count: int) -> Observed:
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
    )
    return Observed(run, poses.shapes)


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


def peak_memory() -> float | None:
    """The most memory [bytes] this process has held until now; None where the system does not say."""
    try:
        import resource
    except ImportError:  # Windows
        return None
    kilobytes = 1.0 if sys.platform == "darwin" else 1024.0
    return kilobytes * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
