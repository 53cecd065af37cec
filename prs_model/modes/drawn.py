"""A machine as triangles, and how its modes move them: the same for every picture of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from ..reduction import Surface
from ..reduction.stand_in import stand_in
from ..synthesis import System

if TYPE_CHECKING:
    from .modes import Modes

AMPLITUDE = 0.06
"""The largest displacement drawn, unless another is asked for, over the machine's size."""

_THICKNESS = 0.012  # of bars, over the diagonal of the box around all nodes and surfaces


def drawn_bodies(system: System) -> dict[str, Surface]:
    """The surface of every body, in its own frame; of one that has none, boxes and bars that stand for it."""
    known = [_in_world(system, name, _described(system, name)) for name in system.elements]
    thickness = _THICKNESS * _diagonal(*_box(known))
    return {name: element.surface or stand_in(element, thickness) for name, element in system.elements.items()}


def box_around(system: System, bodies: Mapping[str, Surface]) -> tuple[FloatArray, FloatArray]:
    """The lowest and highest coordinates (3,) [m] in the world of what is drawn, at rest."""
    return _box([_in_world(system, name, body.points) for name, body in bodies.items()])


def machine_size(system: System, bodies: Mapping[str, Surface]) -> float:
    """The diagonal [m] of the box around what is drawn."""
    return _diagonal(*box_around(system, bodies))


def mode_displacements(
    modes: Modes, bodies: Mapping[str, Surface], numbers: Sequence[int] | None = None
) -> dict[str, FloatArray]:
    """(k, p, 3) of each body in its own axes, the largest anywhere in the machine of length 1 in each mode.

    numbers: which modes, counted from 0; default: all.
    """
    wanted = list(range(len(modes.frequencies)) if numbers is None else numbers)
    moved = {
        name: np.moveaxis(body.recovery.astype(float) @ modes.body_shapes(name)[:, wanted], 2, 0)
        for name, body in bodies.items()
    }
    largest = np.max([np.linalg.norm(each, axis=2).max(axis=1, initial=0.0) for each in moved.values()], axis=0)
    scale = np.where(largest > 0.0, largest, 1.0)[:, None, None]
    return {name: each / scale for name, each in moved.items()}


def largest_length(vectors: FloatArray) -> float:
    """Of vectors (p, 3)."""
    return float(np.linalg.norm(vectors, axis=1).max(initial=0.0))


def _described(system: System, name: str) -> FloatArray:
    """The nodes and surface points (p, 3) of a body."""
    element = system.elements[name]
    return element.positions if element.surface is None else np.vstack([element.positions, element.surface.points])


def _in_world(system: System, name: str, points: FloatArray) -> FloatArray:
    place = system.placements[name]
    return np.asarray(points @ place.rotation.T + place.translation)


def _box(clouds: Sequence[FloatArray]) -> tuple[FloatArray, FloatArray]:
    every = np.vstack(clouds)
    return every.min(axis=0), every.max(axis=0)


def _diagonal(low: FloatArray, high: FloatArray) -> float:
    return float(np.linalg.norm(high - low)) or 1.0
