"""Frequency responses as files: CSV, universal file, picture; complete, or not at all."""

from __future__ import annotations

import csv
import io
import tempfile
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import MissingExtraError, PrsError, short
from ..modes.figure_file import check_writable, told
from ..reduction.storage import whole
from .quantity import DIRECTIONS, Response, listed_pairs, load_unit, motion_unit, unit

if TYPE_CHECKING:
    from .frequency_response import FrequencyResponse

PICTURES = (".png", ".svg", ".pdf")
SUFFIXES = (".csv", ".uff", *PICTURES)

_MOTION: dict[Response, int] = {"receptance": 8, "mobility": 11, "accelerance": 12}  # specific data types of dataset 58
_FORCE, _FREQUENCY, _FRF = 13, 18, 4


def check_file(path: Path) -> None:
    """Raise PrsError or MissingExtraError now if a response could not be written to `path` later."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise PrsError(f"{short(path)}: found a name ending in '{suffix}', expected one of {', '.join(SUFFIXES)}")
    if suffix == ".uff":
        _pyuff()
    if suffix in PICTURES:
        from .picture import matplotlib_figure

        matplotlib_figure()
    check_writable(path)


def save(response: FrequencyResponse, path: Path, pairs: str | Sequence[str] | None = None, title: str = "") -> None:
    """See FrequencyResponse.save."""
    listed = listed_pairs(pairs)
    check_file(path)
    if path.suffix.lower() in PICTURES:
        from .picture import draw

        draw({"": response}, path, DIRECTIONS if pairs is None else ["/".join(pair) for pair in listed], title)
        return
    write = write_csv if path.suffix.lower() == ".csv" else write_uff
    with told(path):
        write(response, path, listed)


def write_csv(response: FrequencyResponse, path: Path, pairs: Sequence[tuple[str, str]]) -> None:
    """A line each frequency, real and imaginary part of each pair; units in the header."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = ["/".join(pair) for pair in pairs]
    units = [unit(*pair, response.quantity) for pair in pairs]
    columns = [f"{part} {name} [{units[k]}]" for k, name in enumerate(names) for part in ("re", "im")]
    writer.writerow(["frequency [Hz]", *columns])
    curves = np.array([response.curve(name) for name in names])
    for k, frequency in enumerate(response.frequencies):
        row = np.column_stack([curves[:, k].real, curves[:, k].imag]).ravel()
        writer.writerow([repr(float(frequency)), *(f"{value:.12e}" for value in row)])
    with whole(path) as file:
        file.write(text.getvalue().encode())


def write_uff(response: FrequencyResponse, path: Path, pairs: Sequence[tuple[str, str]]) -> None:
    """Dataset 164 (SI) and a dataset 58 each pair. Node 1 is the response, 2 the excitation; 1 where they are one."""
    pyuff = _pyuff()
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "response.uff"
        sets = [_si(pyuff), *(_dataset_58(pyuff, response, pair) for pair in pairs)]
        pyuff.UFF(str(made)).write_sets(sets, mode="overwrite")
        with whole(path) as file:
            file.write(made.read_bytes())


def _si(pyuff: ModuleType) -> Any:
    return pyuff.prepare_164(
        units_code=1,
        units_description="SI",
        temp_mode=1,
        length=1.0,
        force=1.0,
        temp=1.0,
        temp_offset=273.15,
    )


def _dataset_58(pyuff: ModuleType, response: FrequencyResponse, pair: tuple[str, str]) -> Any:
    name = "/".join(pair)
    return pyuff.prepare_58(
        binary=0,
        id1=f"{response.quantity} {name} [{response.unit(name)}]"[:80],
        id2=f"response at {response.to}"[:80],
        id3=f"excitation at {response.at}"[:80],
        func_type=_FRF,
        rsp_ent_name="NONE",
        rsp_node=1,
        rsp_dir=DIRECTIONS.index(pair[0]) + 1,
        ref_ent_name="NONE",
        ref_node=1 if response.at == response.to else 2,
        ref_dir=DIRECTIONS.index(pair[1]) + 1,
        abscissa_spacing=0,
        abscissa_spec_data_type=_FREQUENCY,
        abscissa_axis_units_lab="Hz",
        ordinate_spec_data_type=_MOTION[response.quantity],
        ordinate_axis_units_lab=motion_unit(pair[0], response.quantity),
        orddenom_spec_data_type=_FORCE,
        orddenom_axis_units_lab=load_unit(pair[1]),
        data=response.curve(name),
        x=response.frequencies,
    )


def _pyuff() -> ModuleType:
    try:
        import pyuff
    except ImportError as error:
        raise MissingExtraError("pyuff", "uff", "writing a universal file") from error
    return pyuff  # type: ignore[no-any-return]
