"""Bodies as triangles in their own frames, and how a mode moves them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ..arrays import FloatArray
from ..modes import Modes
from ..reduction import Surface
from ..reduction.stand_in import stand_in
from ..synthesis import System

_THICKNESS = 0.02  # of bars, over the machine's size


def drawn_bodies(system: System) -> dict[str, Surface]:
    """The surface of every body; of one that has none, boxes and bars that stand for it."""
    thickness = _THICKNESS * machine_size(system)
    return {name: element.surface or stand_in(element, thickness) for name, element in system.elements.items()}


def machine_size(system: System) -> float:
    """The longest side [m] of the box around all nodes and surfaces."""
    points = np.vstack([seen for name in system.elements for seen in _extremes(system, name)])
    return float(np.max(np.ptp(points, axis=0))) or 1.0


def mode_displacements(modes: Modes, bodies: Mapping[str, Surface], mode: int) -> dict[str, FloatArray]:
    """(p, 3) for each body in its own axes, the largest of all of length one."""
    moved = {
        name: np.asarray(body.recovery @ modes.body_shapes(name)[:, mode], dtype=float) for name, body in bodies.items()
    }
    largest = max(largest_length(each) for each in moved.values()) or 1.0
    return {name: each / largest for name, each in moved.items()}


def largest_length(vectors: FloatArray) -> float:
    """Of vectors (p, 3)."""
    return float(np.sqrt(np.max(np.einsum("pi,pi->p", vectors, vectors), initial=0.0)))


def _extremes(system: System, body: str) -> list[FloatArray]:
    """Nodes of a body, and the corners of the box around its surface (c, 3), in the world."""
    element, place = system.elements[body], system.placements[body]
    points = [element.positions] + ([] if element.surface is None else [_corners(element.surface.points)])
    return [each @ place.rotation.T + place.translation for each in points]


def _corners(points: FloatArray) -> FloatArray:
    bounds = np.array([points.min(axis=0), points.max(axis=0)])
    return np.array(np.meshgrid(*bounds.T)).reshape(3, -1).T
