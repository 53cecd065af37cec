"""A block of all poses as an xarray.Dataset that explains itself: names, units, reasons, and how values are known."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .. import __version__
from ..description.units import SI
from ..readable import pose_text
from ..response.quantity import DIRECTIONS, unit
from .poses import Poses
from .quantities import BOUNDED, DENSE, INTERPOLATED, UNREACHABLE, Block, labels, variables
from .reasons import sentences
from .request import Request
from .tracking import Identities, follow, followed_nowhere

if TYPE_CHECKING:
    import xarray

    from ..machine import Machine

PROOFS: Mapping[int, str] = {
    UNREACHABLE: "none, the pose is unreachable",
    INTERPOLATED: "interpolated, its error estimated to be within the bound, and no mode missed by a count",
    DENSE: "the modes of the whole system",
    BOUNDED: "bounded from both sides at the pose itself, and no mode missed by a count there",
}
"""Codes of `proof` in words."""

_CLOSE = (
    "where two frequencies are one, each share of a single mode is arbitrary; their sum is not. NaN stands for what an "
    "unreachable pose, or a machine that moves without straining anything, does not have"
)

Facts = Mapping[str, str | int | float]


def to_dataset(
    machine: Machine, poses: Poses, request: Request, block: Block, certificate: Facts | None = None
) -> xarray.Dataset:
    """A sweep's block of all poses with names, units and attributes; dimensions are the coordinates that vary.

    Fixed coordinates are scalars; a list of poses has the dimension ``pose``. `reason` and `proof` are CF flags.
    certificate: what was proved, and how, for the attributes. Attributes are text and numbers, fit for any file.
    """
    import xarray

    dims, shape = _pose_dims(poses)
    data = xarray.Dataset(coords=_pose_coordinates(machine, poses))
    labelled = labels(machine, request)
    for name, variable in variables(request).items():
        values = block[name].reshape((*shape, *block[name].shape[1:]))
        attributes: dict[str, Any] = {"long_name": variable.long_name, "units": variable.units}
        data[name] = ((*dims, *variable.dims), values, attributes)
        data = data.assign_coords({dim: (dim, list(labelled[dim])) for dim in variable.dims})
    data["reason"].attrs |= _reason_flags(machine, block["reason"])
    data["proof"].attrs |= _flags(PROOFS, "int8")
    if "static_compliance" in data:
        units = [[unit(response, excitation) for excitation in DIRECTIONS] for response in DIRECTIONS]
        data = data.assign_coords(static_compliance_unit=(("response", "excitation"), units))
    if "identity" in request.quantities:
        data = data.assign(_identities(machine, poses, request, block))
    return data.assign_attrs(_attributes(machine, request, certificate or {}))


def _pose_dims(poses: Poses) -> tuple[tuple[str, ...], tuple[int, ...]]:
    if not poses.is_grid:
        return ("pose",), poses.shape
    several = [(name, length) for name, length in zip(poses.names, poses.shape, strict=True) if length > 1]
    return tuple(name for name, _ in several), tuple(length for _, length in several)


def _pose_coordinates(machine: Machine, poses: Poses) -> dict[str, Any]:
    kinds = machine.kinematics.task.coordinates
    coordinates: dict[str, Any] = {}
    for k, name in enumerate(poses.names):
        attributes = {"long_name": name, "units": kinds[name].label(SI)}
        if poses.points is not None:
            coordinates[name] = ("pose", poses.points[:, k], attributes)
        elif len(poses.axes[k]) > 1:
            coordinates[name] = (name, poses.axes[k], attributes)
        else:
            coordinates[name] = ((), float(poses.axes[k][0]), attributes)
    return coordinates


def _reason_flags(machine: Machine, codes: NDArray[Any]) -> dict[str, Any]:
    """CF flags of the reasons that occur, the sentences beside them, and how many poses each has."""
    found = sentences(machine.kinematics.reach, codes)
    return _flags(found, "int16") | {"flag_counts": [int(np.sum(codes == code)) for code in found]}


def _flags(words: Mapping[int, str], dtype: str) -> dict[str, Any]:
    return {
        "flag_values": np.array(list(words), dtype=dtype),
        "flag_meanings": " ".join(re.sub(r"[^\w.+-]+", "_", each) for each in words.values()),
        "flag_sentences": "; ".join(f"{code}: {each}" for code, each in words.items()),
    }


def _identities(machine: Machine, poses: Poses, request: Request, block: Block) -> dict[str, xarray.DataArray]:
    import xarray

    found = _followed(machine, poses, request, block)
    where, characters = _beginning(machine, poses, request, found)
    coordinates = _pose_coordinates(machine, poses)
    numbers = np.arange(1, request.n_modes + 1)
    tracked = {"tracked": numbers, "character": ("tracked", characters)}
    dims, shape = _pose_dims(poses)

    def array(values: NDArray[Any], last: str, about: dict[str, Any], **attributes: str) -> xarray.DataArray:
        return xarray.DataArray(
            values.reshape((*shape, request.n_modes)), {**coordinates, **about}, (*dims, last), attrs=attributes
        )

    return {
        "identity": array(
            found.identity, "mode", {"mode": numbers}, long_name="whose frequency it is", units="1", comment=where
        ),
        "tracked_frequency": array(
            found.frequency, "tracked", tracked, long_name="natural frequency of one mode, followed", units="Hz"
        ),
        "tracked_overlap": array(
            found.overlap, "tracked", tracked, long_name="least overlap of a step from the start", units="1"
        ),
    }


def _followed(machine: Machine, poses: Poses, request: Request, block: Block) -> Identities:
    if "vectors" not in block:  # no pose is reachable
        return followed_nowhere(poses.size, request.n_modes)
    reference = np.array([machine.reference_pose[name] for name in poses.names])
    frequencies, vectors = np.asarray(block["frame_frequency"]), np.asarray(block["vectors"])  # may be read lazily
    return follow(poses, reference, frequencies, vectors, request.n_modes)


def _beginning(machine: Machine, poses: Poses, request: Request, found: Identities) -> tuple[str, list[str]]:
    """Where the modes have their numbers from, and what each of them is there, in words."""
    if found.start is None:
        return "no pose is reachable; 0 where none could be followed", ["unknown"] * request.n_modes
    start = dict(zip(poses.names, poses.block(found.start, found.start + 1)[0].tolist(), strict=True))
    place = pose_text(start, machine.kinematics.task.coordinates)
    characters = [str(each) for each in machine.modes(request.n_modes, **start).characters()]
    return f"modes are numbered as at {place}; 0 where none could be followed", characters


def _attributes(machine: Machine, request: Request, certificate: Facts) -> dict[str, str | int | float]:
    attributes: dict[str, str | int | float] = {
        "title": f"{machine.description.file.title or machine.name}: map of the workspace",
        "machine": machine.name,
        "source": f"prs-model {__version__}",
        "Conventions": "CF-1.11",
        "quantities": " ".join(request.quantities),
        "n_modes": request.n_modes,
        "tolerance": request.tolerance,
        "comment": _CLOSE,
    }
    if request.band is not None:
        attributes |= {"band_low_hz": request.band[0], "band_high_hz": request.band[1]}
    return attributes | {f"certificate_{name}": value for name, value in certificate.items()}
