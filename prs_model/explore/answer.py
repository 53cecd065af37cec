"""What the page shows of a machine at one pose, with its joints as stiff as asked."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from ..machine import Machine
from ..modes import Modes
from ..reduction import SuperElement, TravellingElement
from ..response import FrequencyResponse
from ..response.band import around
from ..response.damping import Damping, damping_of
from ..response.modal_equations import damping_ratios
from ..synthesis import assemble
from .stiffness import Factors, scaled_joints

Parts = Mapping[str, SuperElement | TravellingElement]

DEFAULT_DAMPING = 0.01
"""Modal damping ratio for the frequency response of a machine whose modes nothing damps."""

_BAND = (0.1, 1.25)  # of the first and the last frequency shown
_LINES = 400
_SPARE = 4  # modes known of the start beyond those shown: one of them may come down among these
_UNDAMPED = 1e-9  # damping ratio of round-off
_CLOSE = 1e-6  # share of a frequency within which an undamped mode is not asked for: its response has no end


@dataclass(frozen=True)
class Question:
    """A pose [m, rad] and factors on the stiffness of joints."""

    pose: Mapping[str, float]
    factors: Factors


@dataclass(frozen=True, eq=False)
class Scope:
    """What holds for all answers of a session: how many modes, and over which frequencies (f,) [Hz] the response.

    start: the modes that others are compared with, a few more than are shown. damping: the ratio that stands in where
    nothing damps the modes, else None.
    """

    start: Modes
    count: int
    band: FloatArray
    damping: float | None


@dataclass(frozen=True, eq=False)
class Answer:
    """The lowest modes, and the receptance at the tool point; None for a machine that nothing holds."""

    question: Question
    modes: Modes
    response: FrequencyResponse | None


def scope_of(machine: Machine, pose: Mapping[str, float], count: int) -> Scope:
    """The scope of a session of so many modes that starts at a pose [m, rad]. Raises UnreachablePoseError."""
    start = machine.assemble(machine.configuration(**pose)).modes(count + _SPARE)
    elastic = start.frequencies[:count][start.frequencies[:count] > 0.0]
    band = np.linspace(_BAND[0] * elastic[0], _BAND[1] * elastic[-1], _LINES) if elastic.size else np.zeros(0)
    return Scope(start, count, band, _stand_in_damping(start))


def answer(machine: Machine, parts: Parts, question: Question, scope: Scope) -> Answer:
    """Solve with given parts for the modes, and for the response over the band and around the modes themselves.

    Raises UnreachablePoseError.
    """
    configuration = machine.configuration(**question.pose)
    joints = scaled_joints(machine, question.factors)
    modes = assemble(machine.description, parts, joints, configuration).modes(scope.count)
    return Answer(question, modes, _response(modes, scope))


def _stand_in_damping(modes: Modes) -> float | None:
    """None where any mode is damped by what the machine states, whatever that is."""
    stated = _ratios(modes, damping_of(modes.system))
    return None if stated.any() else DEFAULT_DAMPING


def _ratios(modes: Modes, damping: Damping) -> FloatArray:
    """Damping ratios (k,), 0 of rigid-body modes too."""
    found = np.nan_to_num(damping_ratios(modes, damping))
    return np.where(found > _UNDAMPED, found, 0.0)


def _response(modes: Modes, scope: Scope) -> FrequencyResponse | None:
    """Over the band, as far as these modes tell, and close round each of them."""
    band = scope.band[scope.band <= _BAND[1] * modes.frequencies[-1]]
    if not band.size:
        return None
    damping = damping_of(modes.system, scope.damping)
    ratios = _ratios(modes, damping)
    peaks = around(modes, ratios)
    lines = np.union1d(band, peaks[(peaks > band[0]) & (peaks < band[-1])])
    endless = modes.frequencies[ratios == 0.0]
    apart = np.abs(lines[:, None] - endless) > _CLOSE * lines[:, None]
    return modes.frequency_response(lines[apart.all(axis=1)], damping)
