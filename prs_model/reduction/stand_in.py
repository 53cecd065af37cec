"""What is drawn of a part that has no surface: the box of its mass, and bars to its nodes."""

from __future__ import annotations

from itertools import product

import numpy as np

from ..arrays import FloatArray, IntArray
from ..finite_elements.rigid_motion import cross_matrix, transfer
from .super_element import SuperElement
from .surface import Surface

_CORNERS = np.array(list(product((-0.5, 0.5), repeat=3)))
_FACES = np.array(
    [
        *((0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1)),
        *((2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)),
    ]
)


def stand_in(element: SuperElement, thickness: float) -> Surface:
    """A cuboid of the part's mass and moments of inertia, and bars of so much thickness [m] from every node to it.

    The cuboid moves as rigidly as the nodes do in the mean; the ends of the bars follow their nodes. Of a grounded
    part only bars to the middle of its nodes are drawn.
    """
    twist = _mean_motion(element)
    centre = element.positions.mean(axis=0)
    pieces = []
    if not element.grounded:
        known = element.mass_properties()
        centre = known.centre
        sizes, axes = _cuboid(known.mass, known.inertia)
        corners = centre + (_CORNERS * np.maximum(sizes, thickness)) @ axes.T
        pieces.append((corners, _FACES, _carried(twist, corners)))
    for node, motion in zip(element.positions, element.motions, strict=True):
        if np.linalg.norm(node - centre) > thickness:
            pieces.append(_bar(node, motion, centre, twist, thickness))
    if not pieces:
        corners = centre + _CORNERS * thickness
        pieces.append((corners, _FACES, _carried(twist, corners)))
    return _joined(pieces)


Piece = tuple[FloatArray, IntArray, FloatArray]


def _bar(node: FloatArray, motion: FloatArray, centre: FloatArray, twist: FloatArray, thickness: float) -> Piece:
    """A bar of square section from a node to the centre."""
    along = (centre - node) / np.linalg.norm(centre - node)
    across = np.cross(along, np.eye(3)[np.argmin(np.abs(along))])
    across *= 0.5 * thickness / np.linalg.norm(across)
    ring = np.array([across, np.cross(along, across), -across, -np.cross(along, across)])
    near = motion[:3] - cross_matrix(ring) @ motion[3:]
    points = np.vstack([node + ring, centre + ring])
    sides = [(k, k + 4, (k + 1) % 4) for k in range(4)] + [((k + 1) % 4, k + 4, (k + 1) % 4 + 4) for k in range(4)]
    ends = [(0, 1, 2), (0, 2, 3), (4, 6, 5), (4, 7, 6)]
    return points, np.array(sides + ends), np.concatenate([near, _carried(twist, centre + ring)])


def _mean_motion(element: SuperElement) -> FloatArray:
    """(6, n): the rigid motion about the body's origin that is nearest to the motions of the nodes."""
    rows = transfer(element.positions).reshape(-1, 6)
    return np.asarray(np.linalg.lstsq(rows, element.motions.reshape(-1, element.size), rcond=1e-10)[0])


def _carried(twist: FloatArray, points: FloatArray) -> FloatArray:
    """(p, 3, n): displacements of points that follow a rigid motion (6, n)."""
    return np.asarray(transfer(points)[:, :3] @ twist)


def _cuboid(mass: float, inertia: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Edges (3,) [m] and axes (3, 3) of a homogeneous cuboid with these moments about its centre."""
    moments, axes = np.linalg.eigh(inertia)
    return np.sqrt(np.maximum(6.0 * (moments.sum() - 2.0 * moments) / mass, 0.0)), axes


def _joined(pieces: list[Piece]) -> Surface:
    starts = np.cumsum([0, *(len(points) for points, _, _ in pieces)])
    return Surface(
        points=np.vstack([points for points, _, _ in pieces]),
        triangles=np.vstack([cells + start for (_, cells, _), start in zip(pieces, starts, strict=False)]),
        source=np.concatenate([recovery for _, _, recovery in pieces]).astype(np.float32),
    )
