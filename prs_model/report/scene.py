"""The machine as triangles in the world, at rest and in every mode; for the page and for glTF alike."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray, IntArray
from ..reduction.stand_in import stand_in

if TYPE_CHECKING:
    from ..modes import Modes

_THICKNESS = 0.012  # of bars, as a share of the machine's size
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
    thickness = _THICKNESS * _extent(modes)
    bodies = {name: element.surface or stand_in(element, thickness) for name, element in system.elements.items()}
    points, moved = {}, {}
    for name, surface in bodies.items():
        place = system.placements[name]
        points[name] = surface.points @ place.rotation.T + place.translation
        own = np.einsum("pin,nk->kpi", surface.recovery.astype(float), modes.body_shapes(name))
        moved[name] = own @ place.rotation.T
    largest = np.max([np.linalg.norm(each, axis=2).max(axis=1, initial=0.0) for each in moved.values()], axis=0)
    scale = np.where(largest > 0.0, largest, 1.0)[:, None, None]
    every = np.vstack(list(points.values()))
    low, high = every.min(axis=0), every.max(axis=0)
    return Scene(
        shapes=tuple(
            Shape(
                name,
                system.stems.get(name, name),
                system.elements[name].grounded,
                points[name],
                surface.triangles,
                edges_of(points[name], surface.triangles),
                moved[name] / scale,
            )
            for name, surface in bodies.items()
        ),
        centre=(low + high) / 2.0,
        size=float(np.linalg.norm(high - low)),
        output=np.asarray(system.output_placement.translation),
        axes=np.asarray(system.output_placement.rotation),
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


def _extent(modes: Modes) -> float:
    """Diagonal [m] of the box around all nodes and surfaces."""
    system = modes.system
    clouds = [
        system.placements[name].act(r)
        for name, element in system.elements.items()
        for r in (element.positions if element.surface is None else element.surface.points[::20])
    ]
    return float(np.linalg.norm(np.ptp(np.array(clouds), axis=0))) or 1.0
