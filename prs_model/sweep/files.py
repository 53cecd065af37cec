"""Maps as files: NetCDF, Zarr, CSV or a picture; complete, or not at all."""

from __future__ import annotations

import csv
import io
import shutil
import tempfile
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import NDArray

from ..errors import MissingExtraError, PrsError, short
from ..modes.figure_file import check_writable, told
from ..reduction.storage import whole

if TYPE_CHECKING:
    import xarray

PICTURES = (".png", ".svg", ".pdf")
SUFFIXES = (".nc", ".zarr", ".csv", *PICTURES)
_LINES = 20_000  # of a table, in memory at a time
_ENGINES: dict[str, Literal["h5netcdf", "netcdf4"]] = {"h5netcdf": "h5netcdf", "netCDF4": "netcdf4"}


def check_file(path: Path) -> None:
    """Raise PrsError or MissingExtraError now if a map could not be written to `path` later."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise PrsError(f"{short(path)}: found a name ending in '{suffix}', expected one of {', '.join(SUFFIXES)}")
    if suffix == ".nc":
        _engine()
    if suffix == ".zarr":
        _check_zarr(path)
        return
    if suffix in PICTURES:
        from ..modes.figure_file import matplotlib_figure

        matplotlib_figure("drawing a map")
    check_writable(path)


def save(data: xarray.Dataset, path: Path, drawn: str = "frequency") -> None:
    """Write a sweep's dataset as the name's ending says, in place of what is there; `drawn` is what a picture shows.

    Raises PrsError as check_file.
    """
    check_file(path)
    suffix = path.suffix.lower()
    if suffix in PICTURES:
        from .drawn.picture import draw

        draw(data, path, drawn)
        return
    with told(path):
        {".nc": _write_netcdf, ".zarr": _write_zarr, ".csv": _write_csv}[suffix](data, path)


def _write_netcdf(data: xarray.Dataset, path: Path) -> None:
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder:
        made = Path(folder) / "map.nc"
        data.to_netcdf(made, engine=_engine())
        made.replace(path)


def _write_zarr(data: xarray.Dataset, path: Path) -> None:
    """Beside, then renamed: a folder cannot be replaced in one step, so that the old one is moved away first."""
    with tempfile.TemporaryDirectory(dir=path.parent, prefix=f".{path.name}.") as folder:
        made, old = Path(folder) / "map.zarr", Path(folder) / "old.zarr"
        data.to_zarr(made, zarr_format=2)
        if path.exists():
            path.replace(old)
        made.replace(path)
        shutil.rmtree(old, ignore_errors=True)


def _write_csv(data: xarray.Dataset, path: Path) -> None:
    """A line each pose, some thousands of them in memory at a time."""
    with whole(path) as file:
        text = io.TextIOWrapper(file, encoding="utf-8", newline="")
        writer = csv.writer(text, lineterminator="\n")
        for k, slab in enumerate(_slabs(data)):
            columns = _table(slab)
            if k == 0:
                writer.writerow(columns)
            writer.writerows(zip(*(column.tolist() for column in columns.values()), strict=True))
        text.detach()  # which flushes, and leaves the file open


def _slabs(data: xarray.Dataset) -> Iterator[xarray.Dataset]:
    """The dataset piece by piece along its first coordinate."""
    reason = data["reason"]
    if not reason.dims:
        yield data
        return
    first, length = reason.dims[0], reason.shape[0]
    step = max(1, _LINES * length // reason.size)
    for start in range(0, length, step):
        yield data.isel({first: slice(start, start + step)})


def _table(data: xarray.Dataset) -> dict[str, NDArray[np.generic]]:
    """A column for each coordinate, and for each entry of each variable, unit in brackets."""
    dims = data["reason"].dims
    columns: dict[str, NDArray[np.generic]] = {}
    for name, coordinate in data.coords.items():
        if set(coordinate.dims) <= set(dims) and "units" in coordinate.attrs:
            spread = coordinate.broadcast_like(data["reason"]).transpose(*dims)
            columns[f"{name} [{coordinate.attrs['units']}]"] = spread.values.ravel()
    for name, variable in data.data_vars.items():
        columns |= _columns(str(name), variable, len(dims))
    return columns


def _columns(name: str, variable: xarray.DataArray, pose_dims: int) -> dict[str, NDArray[np.generic]]:
    """Such as ``frequency 1 [Hz]``, ``static_compliance u w [m/N]``."""
    inner = variable.dims[pose_dims:]
    values = variable.values.reshape(-1, *variable.shape[pose_dims:])
    columns = {}
    for place in np.ndindex(values.shape[1:]):
        chosen = variable.isel(dict(zip(inner, place, strict=True)))
        label = " ".join([name, *(str(variable[dim].values[k]) for dim, k in zip(inner, place, strict=True))])
        unit = str(chosen["static_compliance_unit"].values) if name == "static_compliance" else variable.attrs["units"]
        columns[label if unit == "1" else f"{label} [{unit}]"] = values[(slice(None), *place)]
    return columns


def _engine() -> Literal["h5netcdf", "netcdf4"]:
    """What writes NetCDF here. Raises MissingExtraError where nothing does."""
    for package, engine in _ENGINES.items():
        if find_spec(package) is not None:
            return engine
    raise MissingExtraError("h5netcdf", "maps", "writing a NetCDF file")


def _check_zarr(path: Path) -> None:
    if find_spec("zarr") is None:
        raise MissingExtraError("zarr", "maps", "writing a Zarr store")
    if path.exists() and not any((path / mark).exists() for mark in (".zgroup", "zarr.json")):
        raise PrsError(f"{short(path)}: exists and is no Zarr store; expected another name, or an old store to replace")
    check_writable(path.parent / f"{path.name}.check")
