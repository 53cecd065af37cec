"""What decides the results of a sweep, in one text that can be read and compared."""

from __future__ import annotations

import hashlib
import json
from typing import TYPE_CHECKING, Any

import numpy as np

from ... import __version__
from ...reduction.recipe import file_hash
from ...reduction.store import provenance
from ..request import Request

if TYPE_CHECKING:
    from ...arrays import FloatArray
    from ...machine import Machine
    from ..poses import Poses

VERSION = 2  # raised when a sweep changes its results


def identity(machine: Machine, poses: Poses, request: Request) -> str:
    """Canonical JSON: program, machine as described and changed, content of its files, poses, what is asked.

    Two sweeps with one identity have the same results, up to rounding that differs between processors.
    """
    description = machine.description
    content = {
        "program": f"prs-model {__version__}, sweep {VERSION}",
        "machine": description.file.model_dump(mode="json"),
        "urdf": file_hash(description.urdf_path),
        "parts": {name: _made_from(provenance(part)) for name, part in machine.parts.items()},
        "poses": _values(poses),
        "request": {
            "n_modes": request.n_modes,
            "quantities": list(request.quantities),
            "tolerance": request.tolerance,
            "band": list(request.band or ()),
        },
    }
    return json.dumps(content, sort_keys=True, separators=(",", ":"))


def _made_from(provenance: dict[str, str]) -> dict[str, str]:
    """The recipe of a part and the content of the files it was made from."""
    return {key: provenance[key] for key in ("recipe", "source_sha256") if key in provenance}


def _values(poses: Poses) -> dict[str, Any]:
    if poses.points is not None:
        return {"list": _summary(poses.points)}
    return {name: _summary(axis) for name, axis in zip(poses.names, poses.axes, strict=True)}


def _summary(values: FloatArray) -> dict[str, Any]:
    digits = hashlib.sha256(np.ascontiguousarray(values, dtype="<f8").tobytes()).hexdigest()
    return {"count": len(values), "first": values[0].tolist(), "last": values[-1].tolist(), "sha256": digits}
