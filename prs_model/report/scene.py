"""The machine as triangles in the world, at rest and in every mode; for the page and for glTF alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray, IntArray
from ..modes.drawn import box_around, drawn_bodies, machine_size, mode_displacements

if TYPE_CHECKING:
    from ..modes import Modes
    from ..reduction import Surface
    from ..synthesis import System

_CREASE = np.cos(np.radians(30.0))


@dataclass(frozen=True, eq=False)
class Shape:
    """One body: points (p, 3) [m] in the world, triangles (t, 3), edges (e, 2) to be drawn as lines.

    displacements (k, p, 3): of each mode, the largest anywhere in the machine being 1.
    """

    name: str
    kind: str
    grounded: bool
    points: FloatArray
    triangles: IntArray
    edges: IntArray
    displacements: FloatArray


@dataclass(frozen=True, eq=False)
class Scene:
    """All bodies; centre (3,) and size [m] of the box around them; the output frame's origin, its axes in columns."""

    shapes: tuple[Shape, ...]
    centre: FloatArray
    size: float
    output: FloatArray
    axes: FloatArray


def scene_of(modes: Modes) -> Scene:
    """The bodies on their picture surfaces; of those that have none, what stands for them."""
    system = modes.system
    bodies = drawn_bodies(system)
    low, high = box_around(system, bodies)
    moved = mode_displacements(modes, bodies)
    return Scene(
        shapes=tuple(_shape(system, name, surface, moved[name]) for name, surface in bodies.items()),
        centre=(low + high) / 2.0,
        size=machine_size(system, bodies),
        output=np.asarray(system.output_placement.translation),
        axes=np.asarray(system.output_placement.rotation),
    )


def _shape(system: System, name: str, surface: Surface, moved: FloatArray) -> Shape:
    place = system.placements[name]
    points = surface.points @ place.rotation.T + place.translation
    return Shape(
        name,
        system.stems.get(name, name),
        system.elements[name].grounded,
        points,
        surface.triangles,
        edges_of(points, surface.triangles),
        moved @ place.rotation.T,
    )


def edges_of(points: FloatArray, triangles: IntArray) -> IntArray:
    """(e, 2): where a surface ends, or its faces meet at more than 30 degrees."""
    corners = points[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = normals / np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-300)
    sides = np.sort(np.concatenate([triangles[:, pair] for pair in ((0, 1), (1, 2), (2, 0))]), axis=1)
    owner = np.tile(np.arange(len(triangles)), 3)
    edges, place, count = np.unique(sides, axis=0, return_inverse=True, return_counts=True)
    order = np.argsort(place.ravel(), kind="stable")
    first = np.concatenate([[0], np.cumsum(count)[:-1]])
    smooth = count == 2
    pairs = owner[order][first[smooth][:, None] + np.arange(2)]
    smooth[smooth] = np.einsum("ei,ei->e", normals[pairs[:, 0]], normals[pairs[:, 1]]) > _CREASE
    return np.asarray(edges[~smooth])
