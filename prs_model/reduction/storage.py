"""Super-elements as .npz files: plain numbers and one JSON header, no pickle."""

from __future__ import annotations

import json
import os
import zipfile
import zlib
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import PartFileError, PrsError
from .super_element import SuperElement
from .surface import Surface
from .travelling import TravellingElement

FORMAT = "prs-model super-element"
VERSION = 1

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
            arrays["products"] = element.products
    draft = path.with_name(f".{path.name}.{os.getpid()}")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with draft.open("wb") as file:
            np.savez_compressed(file, allow_pickle=False, header=np.array(json.dumps(header, sort_keys=True)), **arrays)
        draft.replace(path)
    except OSError as error:
        raise PartFileError(path, f"cannot be written: {error.strerror or error}") from error
    finally:
        with suppress(OSError):
            draft.unlink(missing_ok=True)


def load(path: str | Path) -> SuperElement | TravellingElement:
    """Read what `save` wrote. Raises PartFileError when the file is missing, damaged or something else."""
    path = Path(path)
    try:
        with path.open("rb") as opened, np.load(opened, allow_pickle=False) as file:
            arrays = {name: file[name] for name in file.files}
        header = json.loads(str(arrays.pop("header")))
        return _element(header, arrays, path)
    except PartFileError:
        raise
    except FileNotFoundError as error:
        raise PartFileError(path, "there is no such file") from error
    except (OSError, ValueError, KeyError, TypeError, EOFError, AttributeError, IndexError) as error:
        raise _damaged(path, error) from error
    except (zipfile.BadZipFile, zlib.error, NotImplementedError, PrsError) as error:
        raise _damaged(path, error) from error


def load_super_element(path: str | Path) -> SuperElement:
    """Read a super-element that does not travel. Raises PartFileError otherwise."""
    element = load(path)
    if isinstance(element, TravellingElement):
        raise PartFileError(path, f"holds a part that travels with joint {element.joint}, expected one that does not")
    return element


def _header(element: SuperElement) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "version": VERSION,
        "nodes": element.nodes,
        "labels": element.labels,
        "n_modes": element.n_modes,
        "grounded": element.grounded,
        "provenance": dict(element.provenance),
    }


def _arrays(stations: tuple[SuperElement, ...]) -> Arrays:
    """Arrays stacked over the stations; what is the same at all of them is stored once."""
    arrays: Arrays = {
        name: _stacked([getattr(each, name) for each in stations])
        for name in ("stiffness", "mass", "positions", "motions")
    }
    surfaces = [each.surface for each in stations if each.surface is not None]
    if len(surfaces) == len(stations):
        arrays["points"], arrays["triangles"] = surfaces[0].points, surfaces[0].triangles
        arrays["recovery"] = _stacked([surface.recovery for surface in surfaces])
    return arrays


def _stacked(parts: list[NDArray[Any]]) -> NDArray[Any]:
    same = all(np.array_equal(part, parts[0]) for part in parts)
    return np.array(parts[:1] if same else parts)


def _element(header: dict[str, Any], arrays: Arrays, path: Path) -> SuperElement | TravellingElement:
    if header["format"] != FORMAT:
        raise PartFileError(path, f"is '{header['format']}', expected '{FORMAT}'")
    if header["version"] != VERSION:
        raise PartFileError(
            path, f"has format version {header['version']}, this program reads {VERSION}: make the file again"
        )
    if any(array.dtype.kind not in "fi" or not np.all(np.isfinite(array)) for array in arrays.values()):
        raise PartFileError(path, "damaged: it holds values that are not finite numbers; make it again from its source")
    stations = arrays.get("stations")
    elements = tuple(_station(header, arrays, i) for i in range(1 if stations is None else len(stations)))
    if stations is None:
        return elements[0]
    return TravellingElement(header["joint"], stations, elements, arrays.get("products"))


def _station(header: dict[str, Any], arrays: Arrays, index: int) -> SuperElement:
    def of(name: str) -> NDArray[Any]:
        return np.asarray(arrays[name][index if len(arrays[name]) > 1 else 0])

    surface = Surface(arrays["points"], arrays["triangles"], of("recovery")) if "points" in arrays else None
    return SuperElement(
        stiffness=of("stiffness"),
        mass=of("mass"),
        nodes=tuple(header["nodes"]),
        positions=of("positions"),
        motions=of("motions"),
        n_modes=header["n_modes"],
        grounded=header["grounded"],
        surface=surface,
        labels=tuple(header["labels"]),
        provenance=header["provenance"],
    )


def _damaged(path: Path, error: Exception) -> PartFileError:
    return PartFileError(path, f"damaged, or not a stored super-element ({error}); make it again from its source")
