"""How poses are worked out, as arrays and one JSON text: kept without pickling, and gone on with elsewhere."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .enclosed.ritz_at_poses import RitzAtPoses
from .interpolated.counting import Counting
from .interpolated.frames import Frame
from .interpolated.interpolation import Interpolation
from .interpolated.spectral import Axis, Box
from .interpolated.symmetry import Symmetry

Arrays = dict[str, NDArray[Any]]

_KINDS = {kind.__name__: kind for kind in (Interpolation, RitzAtPoses, Box, Axis, Frame, Symmetry, Counting)}
_TEXT = "json"


def to_arrays(found: Interpolation | RitzAtPoses | None, why: str) -> Arrays:
    """Numbers and text, none of which needs pickling. why: how what was found, or nothing, came about."""
    arrays: Arrays = {}
    content = {"why": why, "found": _encoded(found, "found", arrays)}
    return {_TEXT: np.array(json.dumps(content)), **arrays}


def from_arrays(arrays: Arrays) -> tuple[Interpolation | RitzAtPoses | None, str]:
    """What `to_arrays` was given."""
    content = json.loads(str(arrays[_TEXT]))
    return _decoded(content["found"], arrays), content["why"]


def _encoded(value: Any, name: str, arrays: Arrays) -> Any:
    """A value as JSON has it; arrays go to `arrays` under their names."""
    if isinstance(value, np.ndarray):
        arrays[name] = value
        return {"array": name}
    if is_dataclass(value):
        each = {field.name: getattr(value, field.name) for field in fields(value)}
        return {"kind": type(value).__name__, **_encoded(each, name, arrays)}
    if isinstance(value, Mapping):
        return {"mapping": {key: _encoded(each, f"{name}.{key}", arrays) for key, each in value.items()}}
    if isinstance(value, tuple):
        return [_encoded(each, f"{name}.{i}", arrays) for i, each in enumerate(value)]
    if isinstance(value, slice):
        return {"slice": [value.start, value.stop]}
    return value.item() if isinstance(value, np.generic) else value


def _decoded(value: Any, arrays: Arrays) -> Any:
    if isinstance(value, list):
        return tuple(_decoded(each, arrays) for each in value)
    if not isinstance(value, dict):
        return value
    if "array" in value:
        return arrays[value["array"]]
    if "slice" in value:
        return slice(*value["slice"])
    content = {key: _decoded(each, arrays) for key, each in value["mapping"].items()}
    return _KINDS[value["kind"]](**content) if "kind" in value else content
