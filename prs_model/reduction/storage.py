"""Super-elements as .npz files: plain numbers and one JSON header, no pickle."""

from __future__ import annotations

import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import NamedTemporaryFile
from typing import IO, Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Strict

from ..errors import PartFileError, short
from .super_element import SuperElement
from .surface import Surface
from .travelling import TravellingElement

FORMAT = "prs-model super-element"
VERSION = 3

Arrays = dict[str, NDArray[Any]]


def save(element: SuperElement | TravellingElement, path: str | Path) -> None:
    """Store an element; the file appears whole or not at all. Raises PartFileError when it cannot be written."""
    path = Path(path)
    stations = (element,) if isinstance(element, SuperElement) else element.elements
    header = _header(stations[0])
    arrays = _arrays(stations)
    if isinstance(element, TravellingElement):
        header["joint"] = element.joint
        arrays["stations"] = element.stations
        if element.products is not None:
            arrays["products"] = element.products[np.triu_indices(len(stations))]
    contents: dict[str, Any] = {"header": np.array(json.dumps(header, sort_keys=True)), **arrays}
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with whole(path) as file:
            np.savez_compressed(file, **contents)
    except OSError as error:
        raise PartFileError(path, f"cannot be written: {error.strerror or error}") from error


@contextmanager
def whole(path: Path) -> Iterator[IO[bytes]]:
    """A file that appears at `path` once it is written, or not at all, whoever else writes there. Raises OSError."""
    umask = os.umask(0)
    os.umask(umask)
    with NamedTemporaryFile(dir=path.parent, prefix=f".{path.name}.", delete=False) as file:
        try:
            yield file
            file.flush()
            os.fsync(file.fileno())
            os.chmod(file.name, 0o666 & ~umask)
            os.replace(file.name, path)
        except BaseException:
            os.unlink(file.name)
            raise


def load(path: str | Path) -> SuperElement | TravellingElement:
    """Read what `save` wrote. Raises PartFileError when the file is missing, damaged or something else."""
    path = Path(path)
    try:
        with path.open("rb") as opened:
            if opened.read(2) != b"PK":
                raise PartFileError(path, "is no .npz file (a zip archive of arrays): make it again from its source")
            opened.seek(0)
            with np.load(opened, allow_pickle=False) as file:
                arrays = {name: file[name] for name in file.files}
        return _element(json.loads(str(arrays.pop("header"))), arrays, path)
    except PartFileError:
        raise
    except FileNotFoundError as error:
        raise PartFileError(path, "there is no such file") from error
    except Exception as error:  # whatever zip, numpy or json make of damaged bytes
        raise _damaged(path, error) from error


def load_super_element(path: str | Path) -> SuperElement:
    """Read a super-element that does not travel. Raises PartFileError otherwise."""
    element = load(path)
    if isinstance(element, TravellingElement):
        raise PartFileError(path, f"holds a part that travels with joint {element.joint}, expected one that does not")
    return element


class _Header(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid")

    nodes: Annotated[tuple[str, ...], Strict(False)]
    labels: Annotated[tuple[str, ...], Strict(False)]
    n_modes: int
    grounded: bool
    node_sets: dict[str, Annotated[tuple[str, ...], Strict(False)]] = {}
    provenance: dict[str, str]
    joint: str | None = None


def _header(element: SuperElement) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "version": VERSION,
        "nodes": element.nodes,
        "labels": element.labels,
        "n_modes": element.n_modes,
        "grounded": element.grounded,
        **({"node_sets": dict(element.node_sets)} if element.node_sets else {}),
        "provenance": dict(element.provenance),
    }


def _arrays(stations: tuple[SuperElement, ...]) -> Arrays:
    """Arrays stacked over the stations; what is the same at all of them is stored once.

    A surface's recovery, for pictures, is stored in half precision of each column's largest entry.
    """
    arrays: Arrays = {
        name: _stacked([getattr(each, name) for each in stations])
        for name in ("stiffness", "mass", "positions", "motions")
    }
    surfaces = [each.surface for each in stations if each.surface is not None]
    if len(surfaces) == len(stations):
        arrays["points"], arrays["triangles"] = surfaces[0].points, surfaces[0].triangles
        units = [_unit(surface.recovery) for surface in surfaces]
        halved = [(each.recovery / unit).astype(np.float16) for each, unit in zip(surfaces, units, strict=True)]
        arrays["recovery"], arrays["recovery_unit"] = _stacked(halved), _stacked(units)
    return arrays


def _unit(recovery: NDArray[Any]) -> NDArray[Any]:
    """(n,): the power of two at or above the largest entry of each column, so that storing again changes nothing."""
    largest = np.abs(recovery).max(axis=(0, 1), initial=0.0)
    return np.exp2(np.ceil(np.log2(np.where(largest > 0.0, largest, 1.0))))


def _stacked(parts: list[NDArray[Any]]) -> NDArray[Any]:
    same = all(np.array_equal(part, parts[0]) for part in parts)
    return np.array(parts[:1] if same else parts)


def _element(content: dict[str, Any], arrays: Arrays, path: Path) -> SuperElement | TravellingElement:
    found, version = content.pop("format"), content.pop("version")
    if found != FORMAT:
        raise PartFileError(path, f"is '{short(found)}', expected '{FORMAT}'")
    if version != VERSION:
        raise PartFileError(path, f"has format version {version}, this program reads {VERSION}: make the file again")
    header = _Header.model_validate(content)
    if any(array.dtype.kind not in "fi" or not np.all(np.isfinite(array)) for array in arrays.values()):
        raise PartFileError(path, "damaged: it holds values that are not finite numbers; make it again from its source")
    stations = arrays.get("stations")
    elements = tuple(_station(header, arrays, i) for i in range(1 if stations is None else len(stations)))
    if stations is None:
        return elements[0]
    if header.joint is None:
        raise ValueError("no joint for its stations")
    products = _whole(arrays["products"], len(stations)) if "products" in arrays else None
    return TravellingElement(header.joint, stations, elements, products)


def _whole(products: NDArray[Any], count: int) -> NDArray[Any]:
    """P (s, s, n, n) with P_ji = P_ij^T, from those with i <= j."""
    rows, columns = np.triu_indices(count)
    if len(products) != len(rows):
        raise ValueError(f"products are {len(products)}, expected {len(rows)}")
    whole = np.empty((count, count, *products.shape[1:]))
    whole[rows, columns], whole[columns, rows] = products, products.swapaxes(1, 2)
    return whole


def _station(header: _Header, arrays: Arrays, index: int) -> SuperElement:
    def of(name: str) -> NDArray[Any]:
        return np.asarray(arrays[name][index if len(arrays[name]) > 1 else 0])

    surface = None
    if "points" in arrays:
        surface = _surface(arrays, of("recovery"), of("recovery_unit"), of("stiffness").shape[0])
    return SuperElement(
        stiffness=of("stiffness"),
        mass=of("mass"),
        nodes=header.nodes,
        positions=of("positions"),
        motions=of("motions"),
        n_modes=header.n_modes,
        grounded=header.grounded,
        surface=surface,
        labels=header.labels,
        node_sets=header.node_sets,
        provenance=header.provenance,
    )


def _surface(arrays: Arrays, recovery: NDArray[Any], unit: NDArray[Any], size: int) -> Surface:
    points, triangles = arrays["points"], arrays["triangles"]
    p = len(points)
    if points.shape != (p, 3) or triangles.ndim != 2 or triangles.shape[1] != 3 or triangles.dtype.kind != "i":
        raise ValueError(f"points have shape {points.shape} and triangles {triangles.shape} of {triangles.dtype}")
    if recovery.shape != (p, 3, size) or unit.shape != (size,) or not np.all((triangles >= 0) & (triangles < p)):
        raise ValueError(f"recovery has shape {recovery.shape}, expected {(p, 3, size)}, or triangles are of no point")
    return Surface(points, triangles, (recovery * unit).astype(np.float32))


def _damaged(path: Path, error: Exception) -> PartFileError:
    what = short(" ".join(str(error).split()) or type(error).__name__)
    return PartFileError(path, f"damaged, or not a stored super-element ({what}); make it again from its source")
