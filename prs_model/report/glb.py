"""One mode as a binary glTF 2.0 file: the bodies as meshes with a morph target each, whose weight swings.

https://registry.khronos.org/glTF/specs/2.0/glTF-2.0.html; y is up there, so that the machine's z is turned.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..modes.drawn import AMPLITUDE
from .scene import Scene, Shape

_FLOAT, _UNSIGNED = 5126, 5125
_KINDS = {1: "SCALAR", 3: "VEC3"}
_Z_UP = [-(0.5**0.5), 0.0, 0.0, 0.5**0.5]
_KEYS = 24  # of one swing


def glb(scene: Scene, mode: int, name: str, amplitude: float = AMPLITUDE, seconds: float = 1.6) -> bytes:
    """The file's content. amplitude: largest displacement, as a share of the machine's size; seconds: of one swing.

    True frequencies are too fast to be seen; the name says which it is.
    """
    file = _File()
    times = np.linspace(0.0, seconds, _KEYS + 1).astype(np.float32)
    swing = np.sin(2.0 * np.pi * np.arange(_KEYS + 1) / _KEYS).astype(np.float32)
    keys = file.accessor(times, None, bounds=True), file.accessor(swing, None)
    for shape in scene.shapes:
        file.body(shape, mode, amplitude * scene.size)
    bodies = range(len(scene.shapes))
    return file.content(
        {
            "scene": 0,
            "scenes": [{"name": name, "nodes": [len(scene.shapes)]}],
            "nodes": [
                *({"name": shape.name, "mesh": k} for k, shape in enumerate(scene.shapes)),
                {"name": name, "rotation": _Z_UP, "children": list(bodies)},
            ],
            "materials": [_material(shape, k, len(bodies)) for k, shape in enumerate(scene.shapes)],
            "animations": [
                {
                    "name": name,
                    "samplers": [{"input": keys[0], "output": keys[1]}],
                    "channels": [{"sampler": 0, "target": {"node": k, "path": "weights"}} for k in bodies],
                }
            ],
        }
    )


class _File:
    """Numbers in one buffer, with a view and an accessor for each array."""

    def __init__(self) -> None:
        self.buffer = bytearray()
        self.views: list[dict[str, Any]] = []
        self.accessors: list[dict[str, Any]] = []
        self.meshes: list[dict[str, Any]] = []

    def accessor(self, array: NDArray[Any], target: int | None, bounds: bool = False) -> int:
        """Append an array (n,) or (n, 3); its number. target: 34962 of vertices, 34963 of indices."""
        view = {"buffer": 0, "byteOffset": len(self.buffer), "byteLength": array.nbytes}
        self.views.append(view if target is None else {**view, "target": target})
        self.buffer += np.ascontiguousarray(array).tobytes()
        entry: dict[str, Any] = {
            "bufferView": len(self.views) - 1,
            "componentType": _FLOAT if array.dtype == np.float32 else _UNSIGNED,
            "count": len(array),
            "type": _KINDS[array.shape[1] if array.ndim == 2 else 1],
        }
        if bounds:
            columns = array.reshape(len(array), -1)
            entry |= {"min": columns.min(axis=0).tolist(), "max": columns.max(axis=0).tolist()}
        self.accessors.append(entry)
        return len(self.accessors) - 1

    def body(self, shape: Shape, mode: int, amplitude: float) -> None:
        """Append a body's mesh."""
        points = shape.points.astype(np.float32)
        moved = (amplitude * shape.displacements[mode]).astype(np.float32)
        primitive = {
            "attributes": {"POSITION": self.accessor(points, 34962, bounds=True)},
            "indices": self.accessor(shape.triangles.astype(np.uint32).ravel(), 34963),
            "material": len(self.meshes),
            "targets": [{"POSITION": self.accessor(moved, 34962, bounds=True)}],
        }
        self.meshes.append({"name": shape.name, "primitives": [primitive], "weights": [0.0]})

    def content(self, document: dict[str, Any]) -> bytes:
        """Header, JSON chunk, binary chunk."""
        whole = {
            "asset": {"version": "2.0", "generator": "prs-model"},
            **document,
            "meshes": self.meshes,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.buffer)}],
        }
        text = json.dumps(whole, separators=(",", ":")).encode()
        text += b" " * (-len(text) % 4)
        length = 12 + 8 + len(text) + 8 + len(self.buffer)
        return b"".join(
            [
                struct.pack("<4sII", b"glTF", 2, length),
                struct.pack("<I4s", len(text), b"JSON"),
                text,
                struct.pack("<I4s", len(self.buffer), b"BIN\0"),
                bytes(self.buffer),
            ]
        )


def _material(shape: Shape, number: int, count: int) -> dict[str, Any]:
    """A colour by the body's place among all, from blue to yellow; what is grounded can be seen through."""
    share = number / max(count - 1, 1)
    colour = [0.1 + 0.75 * share, 0.25 + 0.5 * share, 0.5 - 0.3 * share, 0.25 if shape.grounded else 1.0]
    surface = {"baseColorFactor": colour, "metallicFactor": 0.1, "roughnessFactor": 0.7}
    alpha = {"alphaMode": "BLEND"} if shape.grounded else {}
    return {"name": shape.name, "pbrMetallicRoughness": surface, "doubleSided": True, **alpha}
