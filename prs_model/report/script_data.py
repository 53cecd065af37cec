"""What the page's scripts need: the machine as triangles in every mode, and the frequency responses."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .embedding import numbers_text

if TYPE_CHECKING:
    from .page import Pose
    from .scene import Scene, Shape

_FINE, _COARSE = np.dtype("<i2"), np.dtype("i1")  # of displacements, at the first pose and at others
_STEPS = 65535  # along the longest side of the box around all points


def script_data(poses: Sequence[Pose]) -> dict[str, Any]:
    """What the scripts need. Poses of one machine share their triangles, as far as these are the same."""
    meshes: list[dict[str, Any]] = []
    listed: list[dict[str, Any]] = []
    for pose in poses:
        mesh = _mesh(pose.scene)
        if mesh not in meshes:
            meshes.append(mesh)
        scene = _scene(pose.scene, _FINE if not listed else _COARSE)
        listed.append({**_pose(pose), "scene": scene, "mesh": meshes.index(mesh)})
    return {"meshes": meshes, "poses": listed}


def _pose(pose: Pose) -> dict[str, Any]:
    """Frequencies, labels and responses, to the digits that a screen shows."""
    modes, response = pose.study.modes, pose.study.response
    curves = {} if response is None else {axis: _complex(response.curve(axis)) for axis in "uvw"}
    return {
        "frequencies": [round(float(f), 4) for f in modes.frequencies],
        "labels": [f"{each.group} {each.motion}" for each in pose.study.characters],
        "frf": None
        if response is None
        else {"hz": [round(float(f), 4) for f in response.frequencies], "curves": curves},
    }


def _mesh(scene: Scene) -> dict[str, Any]:
    """How the points of all bodies in one list are joined, the grounded bodies last."""
    shapes = _ordered(scene)
    kinds = list(dict.fromkeys(shape.kind for shape in shapes))
    starts = np.cumsum([0, *(len(shape.points) for shape in shapes)])[:-1]
    free = [shape for shape in shapes if not shape.grounded]
    return {
        "kind": numbers_text(
            np.concatenate([np.full(len(s.points), kinds.index(s.kind)) for s in shapes]).astype("u1")
        ),
        "triangles": numbers_text(_numbered([shape.triangles for shape in shapes], starts)),
        "edges": numbers_text(_numbered([shape.edges for shape in shapes], starts)),
        "freeTriangles": sum(shape.triangles.size for shape in free),
        "freeEdges": sum(shape.edges.size for shape in free),
    }


def _scene(scene: Scene, moved: np.dtype[Any]) -> dict[str, Any]:
    """Where the points are, as whole numbers up to 65535 within the box around them; displacements (k, p, 3) as whole
    numbers of a type, its largest being 1."""
    shapes, largest = _ordered(scene), np.iinfo(moved).max
    points = np.vstack([shape.points for shape in shapes])
    displacements = np.concatenate([shape.displacements for shape in shapes], axis=1)
    low, step = points.min(axis=0), float(np.ptp(points, axis=0).max()) / _STEPS or 1.0
    return {
        "points": numbers_text(np.round((points - low) / step).astype("<u2")),
        "low": low.tolist(),
        "step": step,
        "moved": numbers_text(np.round(largest * np.clip(displacements, -1.0, 1.0)).astype(moved)),
        "movedBytes": moved.itemsize,
        "centre": scene.centre.tolist(),
        "size": scene.size,
        "output": scene.output.tolist(),
        "axes": scene.axes.T.tolist(),
    }


def _ordered(scene: Scene) -> list[Shape]:
    return sorted(scene.shapes, key=lambda shape: shape.grounded)


def _numbered(cells: Sequence[NDArray[Any]], starts: NDArray[Any]) -> NDArray[Any]:
    return np.concatenate([(each + start).ravel() for each, start in zip(cells, starts, strict=True)]).astype("<u4")


def _complex(curve: NDArray[np.complex128]) -> list[list[float]]:
    return [[float(f"{x:.5g}") for x in part] for part in (curve.real, curve.imag)]
