"""Everything known of the modes in one labelled table."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from ..reduction.super_element import AXES
from ..response.quantity import DIRECTIONS, unit

if TYPE_CHECKING:
    import xarray

    from .energy import Energies
    from .modes import Modes


def table(modes: Modes) -> xarray.Dataset:
    """Of each mode: frequency [Hz], character, shares of energy, and its flexibility where no mode is at 0 Hz.

    kinetic (body, mode), strain (part, mode), both by limb, joint_strain (joint, axis, mode), flexibility and
    flexibility_share (mode, direction).
    """
    import xarray

    joints = modes.joint_strain_by_direction()
    data = xarray.Dataset(
        {
            "frequency": ("mode", modes.frequencies, {"units": "Hz"}),
            "character": ("mode", [str(each) for each in modes.characters()]),
            "kinetic": _shares("body", modes.kinetic_energy()),
            "strain": _shares("part", modes.strain_energy()),
            "kinetic_by_limb": _shares("moving_limb", modes.kinetic_energy_by_limb()),
            "strain_by_limb": _shares("strained_limb", modes.strain_energy_by_limb()),
            "joint_strain": (("joint", "axis", "mode"), _stacked(joints, (6, len(modes.frequencies))), {"units": "1"}),
        },
        coords={
            "mode": np.arange(1, len(modes.frequencies) + 1),
            "body": list(modes.kinetic_energy()),
            "part": list(modes.strain_energy()),
            "moving_limb": list(modes.kinetic_energy_by_limb()),
            "strained_limb": list(modes.strain_energy_by_limb()),
            "joint": list(joints),
            "axis": list(AXES),
        },
    )
    return data if modes.is_rigid.any() else data.assign(_flexibility(modes))


def _flexibility(modes: Modes) -> dict[str, xarray.DataArray]:
    import xarray

    units = [unit(direction, direction) for direction in DIRECTIONS]
    coords = {"direction": list(DIRECTIONS), "unit": ("direction", units)}
    return {
        "flexibility": xarray.DataArray(modes.modal_flexibility(), coords, ("mode", "direction")),
        "flexibility_share": xarray.DataArray(modes.flexibility_shares(), coords, ("mode", "direction")),
    }


def _shares(dimension: str, energies: Energies) -> tuple[tuple[str, str], FloatArray, dict[str, str]]:
    return (dimension, "mode"), np.array(list(energies.values())), {"units": "1"}


def _stacked(energies: Energies, shape: tuple[int, ...]) -> FloatArray:
    return np.array(list(energies.values())).reshape(-1, *shape)
