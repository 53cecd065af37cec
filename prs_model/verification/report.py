"""What a verification found: plain data, pose axis first."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from ..arrays import FloatArray, IntArray
from ..description.units import Dimension
from ..errors import PrsError
from ..modes import Modes

Characters = tuple[tuple[str, ...], ...]


def relative_difference(frequencies: FloatArray, complete: FloatArray, what: str) -> FloatArray:
    """f / f_complete - 1, of arrays [Hz] of one shape; zero where both are motions that strain nothing.

    what: is compared, for messages. Raises PrsError where the complete model alone has such a motion.
    """
    free = complete == 0.0
    if np.any(frequencies[free] > 0.0):
        raise PrsError(
            f"{what}: found {frequencies[free].max():.4g} Hz where the complete model moves freely, expected 0 Hz; "
            "there is no relative difference from 0: hold that motion, such as by its joint's drive"
        )
    return np.asarray(np.where(free, 0.0, frequencies / np.where(free, 1.0, complete) - 1.0))


@dataclass(frozen=True, eq=False)
class ModelRun:
    """One model at all poses, complete or reduced.

    own: of a reduction, the complete model with the same interface kinematics. size: number of coordinates.
    frequencies (poses, c) [Hz], ascending; c is more than the count that was asked for, so that pairs are not cut.
    characters: of the modes of every pose. seconds (poses,): taken for each; preparation [s]: before the first pose.
    residuals (poses, c): error bounds of the squared frequencies, of a complete model. peak_memory [bytes]: of the
    process until then, None where the system does not say or poses came from a cache. reference_modes: at the first
    pose, for pictures. in_place (poses, count) [Hz]: with travelling contacts reduced where they are, not interpolated.
    """

    name: str
    title: str
    own: str
    size: int
    frequencies: FloatArray
    characters: Characters
    seconds: FloatArray
    preparation: float
    reference_modes: Modes
    residuals: FloatArray | None = None
    peak_memory: float | None = None
    family: str = ""
    modes_per_part: int | None = None
    in_place: FloatArray | None = None

    @property
    def first_seconds(self) -> float:
        """Time [s] until the first pose is solved, preparation included."""
        return float(self.preparation + self.seconds[0])

    @property
    def further_seconds(self) -> float | None:
        """Median time [s] of the further poses; None when there is one pose only."""
        return float(np.median(self.seconds[1:])) if len(self.seconds) > 1 else None


@dataclass(frozen=True, eq=False)
class Comparison:
    """One reduction against one complete model at all poses, the modes paired by their shapes.

    partners (poses, count): the reduction's mode that answers each mode of the complete model. clusters (poses, count):
    equal for modes too close to be told apart. discrepancies (poses, count): of a pair's frequencies, relative to the
    complete model. margins (poses, count): the same in the order of frequencies, never negative for the same interface
    kinematics (min-max principle). mac (poses, count, count): eq. (23) of the pairs, close modes turned to match.
    """

    reduction: str
    model: str
    partners: IntArray
    clusters: IntArray
    discrepancies: FloatArray
    margins: FloatArray
    mac: FloatArray

    @property
    def rms(self) -> FloatArray:
        """(poses,): root mean square of the discrepancies over the modes (Table 4)."""
        return np.asarray(np.sqrt(np.mean(self.discrepancies**2, axis=1)))

    @property
    def largest(self) -> FloatArray:
        """(poses,): the largest discrepancy, in absolute value."""
        return np.asarray(np.abs(self.discrepancies).max(axis=1))

    @property
    def mac_diagonal(self) -> FloatArray:
        """(poses, count): MAC of each pair."""
        return np.asarray(np.diagonal(self.mac, axis1=1, axis2=2))


@dataclass(frozen=True, eq=False)
class VerificationReport:
    """Reductions held against complete-order models of one machine.

    poses: coordinate to value [m, rad], the first one shown in full; coordinates: what each is. count: modes compared.
    joint_stiffness: the factor on the stiffness of all joints. `curve` names the reductions that only serve the curve
    of error against coordinates. published: frequencies [Hz] at the first pose by where they come from. environment:
    what times depend on.
    """

    machine: str
    title: str
    poses: tuple[Mapping[str, float], ...]
    coordinates: Mapping[str, Dimension]
    count: int
    models: tuple[ModelRun, ...]
    reductions: tuple[ModelRun, ...]
    comparisons: tuple[Comparison, ...]
    joint_stiffness: float = 1.0
    curve: tuple[str, ...] = ()
    published: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    environment: str = ""

    @property
    def shown(self) -> tuple[ModelRun, ...]:
        """The reductions that tables show."""
        return tuple(run for run in self.reductions if run.name not in self.curve)

    def comparison(self, reduction: str, model: str) -> Comparison:
        """One reduction against one model, both by name."""
        return next(each for each in self.comparisons if (each.reduction, each.model) == (reduction, model))

    def least_margin(self, reduction: ModelRun) -> float | None:
        """The least of f_reduced / f_complete - 1 against the model of the same interface kinematics, if that ran."""
        return self._margin(reduction, reduction.frequencies)

    def least_margin_in_place(self, reduction: ModelRun) -> float | None:
        """The same with travelling contacts reduced where they are, if that was asked for."""
        return None if reduction.in_place is None else self._margin(reduction, reduction.in_place)

    def _margin(self, reduction: ModelRun, frequencies: FloatArray) -> float | None:
        own = [model.frequencies for model in self.models if model.name == reduction.own]
        if not own:
            return None
        what = f"{reduction.name} against {reduction.own}"
        return float(relative_difference(frequencies[:, : self.count], own[0][:, : self.count], what).min())
