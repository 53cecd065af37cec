"""Hold reduced models against the complete order, pose by pose."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from ..errors import PrsError, UnknownNameError
from ..machine import Machine
from ..modes.mac import in_common, pairing
from .environment import environment
from .full_parts import check_full_parts
from .poses import default_poses, distinct
from .reductions import COUPLINGS, REDUCTIONS, Reduction
from .report import Comparison, VerificationReport, relative_difference
from .runs import Observed, complete_run, reduced_run


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
    in_place: bool = False,
) -> VerificationReport:
    """Compare the lowest `count` modes of reduced models with those of the complete order.

    poses: coordinate to value [m, rad], those left out at their reference; default: `default_poses`. models: "A" with
    interfaces averaged, "B" with rigid ones. curve: further reductions, for the curve of error against coordinates.
    cache: a folder that keeps reduced parts and solved poses. joint_stiffness: what the report shall say of the machine
    (see `with_joint_stiffness`). in_place: also reduce travelling contacts where they are at every pose, for the bound.
    Raises PrsError or PartFileError when parts have no full matrices or too few coordinates, UnreachablePoseError.
    """
    if not reductions:
        raise PrsError("found no reduction to verify, expected one at least, such as those of REDUCTIONS")
    check_full_parts(machine)
    wanted = _poses(machine, poses)
    configurations = [machine.configuration(**pose) for pose in wanted]
    variants = [(each, _stored_in(each.of(machine), cache).description) for each in (*reductions, *curve)]
    complete = [complete_run(machine, name, configurations, count, cache) for name in _known(models)]
    runs, comparisons = [], []
    for each, described in variants:
        bounds = in_place and each not in curve
        reduced = reduced_run(Machine(described), each, configurations, count, in_place=bounds)
        comparisons += [compare(reduced, model, count) for model in complete]
        runs.append(reduced.run)
    return VerificationReport(
        machine=machine.name,
        title=machine.description.file.title,
        poses=tuple(configuration.pose for configuration in configurations),
        coordinates=machine.kinematics.task.coordinates,
        count=count,
        models=tuple(each.run for each in complete),
        reductions=tuple(runs),
        comparisons=tuple(comparisons),
        joint_stiffness=joint_stiffness,
        curve=tuple(each.name for each in curve),
        published=_published(machine, wanted[0]) if joint_stiffness == 1.0 else {},
        environment=environment(),
    )


def compare(reduced: Observed, complete: Observed, count: int) -> Comparison:
    """Pair the modes of a reduced and a complete model at every pose; discrepancies of the lowest `count`.

    Raises PrsError where the complete model moves freely and its partner does not.
    """
    pairs = []
    for k, (a, b) in enumerate(zip(complete.shapes, reduced.shapes, strict=True)):
        most = len(reduced.run.frequencies[k])
        shapes_a, shapes_b = in_common(a, b)
        pairs.append(
            pairing(shapes_a[:, :most], shapes_b, complete.run.frequencies[k][:most], reduced.run.frequencies[k])
        )
    partners = np.array([pair.partners[:count] for pair in pairs])
    there, here = complete.run.frequencies[:, :count], reduced.run.frequencies
    what = f"{reduced.run.name} against {complete.run.name}"
    return Comparison(
        reduction=reduced.run.name,
        model=complete.run.name,
        partners=partners,
        clusters=np.array([pair.clusters[:count] for pair in pairs]),
        discrepancies=relative_difference(np.take_along_axis(here, partners, axis=1), there, what),
        margins=relative_difference(here[:, :count], there, what),
        mac=np.array([pair.mac[:count, :count] for pair in pairs]),
    )


def _poses(machine: Machine, poses: Sequence[Mapping[str, float]] | None) -> tuple[dict[str, float], ...]:
    if poses is None:
        return default_poses(machine)
    if not poses:
        raise PrsError("found no pose to verify at, expected one at least")
    return distinct([dict(machine.reference_pose) | dict(pose) for pose in poses])


def _published(machine: Machine, first: Mapping[str, float]) -> dict[str, tuple[float, ...]]:
    section = machine.description.file.verification
    if section is None or first != dict(machine.reference_pose):
        return {}
    return {name: tuple(map(float, each)) for name, each in section.published.items()}


def _known(models: Sequence[str]) -> tuple[str, ...]:
    for name in models:
        if name not in COUPLINGS:
            raise UnknownNameError("model", name, list(COUPLINGS))
    if not models:
        raise PrsError("found no model to verify against, expected A or B or both")
    return tuple(dict.fromkeys(models))


def _stored_in(machine: Machine, cache: Path | None) -> Machine:
    """The machine with its parts reduced anew, or kept in the cache; what is stored with the machine stays as it is."""
    return machine.replace({"reduction.store": None if cache is None else str(cache / "parts" / machine.name)})
