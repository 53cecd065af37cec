"""What a block of a sweep holds: names, dimensions and units of each quantity, and blocks yet to be filled."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..response.quantity import DIRECTIONS
from .request import Request

if TYPE_CHECKING:
    from ..machine import Machine

Block = dict[str, NDArray[Any]]
"""Arrays by variable, the pose axis first; NaN where a pose is unreachable or a quantity does not exist."""

UNREACHABLE, INTERPOLATED, DENSE, BOUNDED = range(4)
"""Codes of `proof`: none; interpolated, and modes counted; the modes of the whole system; bounded from both sides at
this pose, and modes counted."""

Labels = Mapping[str, Sequence[int] | Sequence[str]]
"""What stands along each dimension, by its name."""


@dataclass(frozen=True)
class Variable:
    """A variable of a block: the request's quantity it belongs to, its dimensions after the pose, words and unit."""

    quantity: str
    dims: tuple[str, ...]
    long_name: str
    units: str
    dtype: str = "float64"


VARIABLES: Mapping[str, Variable] = MappingProxyType(
    {
        "frequency": Variable("frequency", ("mode",), "natural frequency", "Hz"),
        "bound": Variable("frequency", ("mode",), "bound of the relative error of the frequency", "1"),
        "reason": Variable("frequency", (), "why the pose is not reachable", "1", "int16"),
        "proof": Variable("frequency", (), "how the values are known", "1", "int8"),
        "static_compliance": Variable(
            "static_compliance",
            ("response", "excitation"),
            "compliance at rest of the end-reference point in the output frame",
            "see static_compliance_unit",
        ),
        "flexibility_share": Variable(
            "flexibility_share", ("mode", "direction"), "share of the mode in the compliance at rest", "1"
        ),
        "kinetic_energy": Variable("kinetic_energy", ("mode", "body"), "share of the mode's kinetic energy", "1"),
        "strain_energy": Variable("strain_energy", ("mode", "member"), "share of the mode's strain energy", "1"),
        "frf_peak": Variable("frf_peak", ("axis",), "largest receptance of the end-reference point in the band", "m/N"),
        "frf_peak_frequency": Variable("frf_peak", ("axis",), "frequency of the largest receptance", "Hz"),
    }
)
"""Everything a block may hold besides `vectors` and `frame_frequency`, from which identities are followed."""


def variables(request: Request) -> dict[str, Variable]:
    """The variables a request asks for."""
    return {name: variable for name, variable in VARIABLES.items() if variable.quantity in request.quantities}


def labels(machine: Machine, request: Request) -> dict[str, tuple[int, ...] | tuple[str, ...]]:
    """What stands along each dimension of a machine's blocks."""
    bodies, joints = tuple(machine.parts), tuple(joint.name for joint in machine.joints)
    return {
        "mode": tuple(range(1, request.n_modes + 1)),
        "direction": DIRECTIONS,
        "response": DIRECTIONS,
        "excitation": DIRECTIONS,
        "axis": DIRECTIONS[:3],
        "body": bodies,
        "member": (*bodies, *(f"joint {name}" if name in bodies else name for name in joints)),
    }


def blank(request: Request, labelled: Labels, count: int) -> Block:
    """A block of `count` poses of which nothing is known: NaN, and zero for reason and proof."""
    return {
        name: np.full(
            (count, *(len(labelled[dim]) for dim in variable.dims)),
            np.nan if variable.dtype == "float64" else 0,
            dtype=variable.dtype,
        )
        for name, variable in variables(request).items()
    }
