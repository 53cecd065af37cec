"""Frequency responses as universal files: datasets 164 (units), 15 (nodes) and a 58 for each entry."""

from __future__ import annotations

import tempfile
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import FloatArray
from ..errors import MissingExtraError, PrsError
from ..reduction.storage import whole
from .quantity import DIRECTIONS, Response, is_rotation, load_unit, motion_unit, six_digits

if TYPE_CHECKING:
    from .frequency_response import FrequencyResponse

_MOTION: dict[Response, int] = {"receptance": 8, "mobility": 11, "accelerance": 12}  # specific data types of dataset 58
_FORCE, _FREQUENCY, _FRF = 13, 18, 4
_EVEN = 0.01  # of a step: how far lines may be from where six digits of the first and the step put them


def write_uff(response: FrequencyResponse, path: Path, pairs: Sequence[tuple[str, str]]) -> None:
    """Write the file whole, or not at all; values have twelve digits, frequencies six.

    Nodes have the numbers and places of `FrequencyResponse.nodes`. Raises PrsError for a single frequency, or for
    some that six digits do not tell apart.
    """
    library, even = pyuff(), _is_even(response.frequencies)
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "response.uff"
        sets = [
            _si(library),
            _dataset_15(library, response),
            *(_dataset_58(library, response, pair, even) for pair in pairs),
        ]
        library.UFF(str(made)).write_sets(sets, mode="overwrite")
        with whole(path) as file:
            file.write(made.read_bytes())


def pyuff() -> ModuleType:
    """The library that writes the datasets. Raises MissingExtraError."""
    try:
        import pyuff as library
    except ImportError as error:
        raise MissingExtraError("pyuff", "uff", "writing a universal file") from error
    return library  # type: ignore[no-any-return]


def _is_even(frequencies: FloatArray) -> bool:
    """Whether the first line and the step say it all. Raises PrsError for lines that the file would not tell apart."""
    if len(frequencies) < 2:
        raise PrsError("a universal file needs two frequencies at least, found one; write .csv")
    step = frequencies[1] - frequencies[0]
    stored = six_digits(frequencies[0]) + six_digits(step) * np.arange(len(frequencies))
    if step > 0.0 and np.all(np.abs(stored - frequencies) <= _EVEN * step):
        return True
    rounded = np.array([six_digits(each) for each in frequencies])
    same = np.flatnonzero(np.diff(rounded) == 0.0)
    if same.size:
        one, other = frequencies[same[0] : same[0] + 2]
        raise PrsError(
            f"a universal file has six digits for frequencies, which do not tell {one:.10g} and {other:.10g} Hz apart; "
            "write .csv, or ask for frequencies further apart"
        )
    return False


def _si(library: ModuleType) -> Any:
    return library.prepare_164(
        units_code=1,
        units_description="SI",
        temp_mode=1,
        length=1.0,
        force=1.0,
        temp=1.0,
        temp_offset=273.15,
    )


def _dataset_15(library: ModuleType, response: FrequencyResponse) -> Any:
    """Coordinates are along u, v, w, in which directions are read."""
    numbers = [node.number for node in response.nodes.values()]
    x, y, z = (list(map(float, row)) for row in np.array([node.position for node in response.nodes.values()]).T)
    return library.prepare_15(node_nums=numbers, x=x, y=y, z=z)


def _dataset_58(library: ModuleType, response: FrequencyResponse, pair: tuple[str, str], even: bool) -> Any:
    name = "/".join(pair)
    return library.prepare_58(
        binary=0,
        id1=f"{response.quantity} {name} [{response.unit(name)}]"[:80],
        id2=f"response at {response.to}"[:80],
        id3=f"excitation at {response.at}"[:80],
        func_type=_FRF,
        rsp_ent_name="NONE",
        rsp_node=response.nodes[response.to].number,
        rsp_dir=DIRECTIONS.index(pair[0]) + 1,
        ref_ent_name="NONE",
        ref_node=response.nodes[response.at].number,
        ref_dir=DIRECTIONS.index(pair[1]) + 1,
        abscissa_spacing=int(even),
        abscissa_spec_data_type=_FREQUENCY,
        abscissa_axis_units_lab="Hz",
        ordinate_spec_data_type=_MOTION[response.quantity],
        ordinate_len_unit_exp=0 if is_rotation(pair[0]) else 1,
        ordinate_axis_units_lab=motion_unit(pair[0], response.quantity),
        orddenom_spec_data_type=_FORCE,
        orddenom_force_unit_exp=1,
        orddenom_len_unit_exp=1 if is_rotation(pair[1]) else 0,
        orddenom_axis_units_lab=load_unit(pair[1]),
        data=response.curve(name),
        x=response.frequencies,
    )
