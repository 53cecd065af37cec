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
from ..response.damping import damping_of
from ..response.modal_equations import damping_ratios
from ..synthesis import assemble
from .stiffness import Factors, scaled_joints

Parts = Mapping[str, SuperElement | TravellingElement]

DEFAULT_DAMPING = 0.01
"""Modal damping ratio for the frequency response of a machine that states no damping."""

_BAND = (0.1, 1.25)  # of the first and the last frequency shown
_LINES = 400


@dataclass(frozen=True)
class Question:
    """A pose [m, rad] and factors on the stiffness of joints."""

    pose: Mapping[str, float]
    factors: Factors


@dataclass(frozen=True, eq=False)
class Answer:
    """The lowest modes, and the receptance at the tool point; None for a machine that nothing holds."""

    question: Question
    modes: Modes
    response: FrequencyResponse | None


def answer(machine: Machine, parts: Parts, question: Question, count: int, band: FloatArray | None = None) -> Answer:
    """Solve for `count` modes with given parts, and for the response over `band` (f,) [Hz] and at the modes themselves.

    band: by default from well below the first to beyond the last mode. Raises UnreachablePoseError.
    """
    configuration = machine.configuration(**question.pose)
    joints = scaled_joints(machine, question.factors)
    modes = assemble(machine.description, parts, joints, configuration).modes(count)
    return Answer(question, modes, _response(modes, band, default_damping(machine)))


def default_damping(machine: Machine) -> float | None:
    """None where the machine states its damping, else the ratio that stands in for it."""
    stated = machine.description.file.damping
    has_some = bool(np.any(stated.modal)) or stated.rayleigh is not None or bool(stated.joints)
    return None if has_some else DEFAULT_DAMPING


def band_of(modes: Modes) -> FloatArray:
    """Frequencies (f,) [Hz] around the modes shown; empty for a machine without an elastic one."""
    elastic = modes.frequencies[modes.frequencies > 0.0]
    return np.linspace(_BAND[0] * elastic[0], _BAND[1] * elastic[-1], _LINES) if elastic.size else np.zeros(0)


def _response(modes: Modes, band: FloatArray | None, damping: float | None) -> FrequencyResponse | None:
    band = band_of(modes) if band is None else band
    if not band.size or modes.is_rigid.all():
        return None
    every, model = modes.system.modes(modes.system.size), damping_of(modes.system, damping)
    peaks = around(every, damping_ratios(every, model))
    return every.frequency_response(np.union1d(band, peaks[(peaks > band[0]) & (peaks < band[-1])]), model)
