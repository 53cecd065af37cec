"""Integrals of shape functions over the part of a surface that lies between planes.

The weights w_i = int N_i dA of a patch reproduce its area and, facets being flat, its first moments exactly; with
mid-side nodes halfway along straight edges its second moments as well, since N_i then interpolate quadratics exactly:

    sum_i w_i X_i^T X_i = int X^T X dA

is that of the patch itself and positive definite, although w_i of a corner may be negative where its facet is cut.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray, IntArray

MIDPOINTS = np.array([[1.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 0.0, 1.0]]) / 2.0
"""Barycentric places of the three-point rule, which is exact for quadratics."""


def area_weights(points: FloatArray, facets: IntArray, distances: FloatArray) -> FloatArray:
    """w_i = int N_i dA (n,) [m^2] over the part of a surface that lies on the inner side of all of h planes.

    points: (n, 3) [m]. facets: (t, 3) corners, or (t, 6) with the nodes between the first two, the last two, and the
    last and first. distances: (n, h) of every point from the planes, positive inside. Facets are taken as flat.
    """
    corners = facets[:, :3]
    owners: IntArray = np.arange(len(facets))
    pieces: FloatArray = np.tile(np.eye(3), (len(facets), 1, 1))
    for heights in distances.T:
        owners, pieces = _inner(owners, pieces, heights[corners])
    edges = points[corners[:, 1:]] - points[corners[:, :1]]
    areas = np.linalg.norm(np.cross(edges[:, 0], edges[:, 1]), axis=1) / 2.0
    shares = _integrals(pieces, facets.shape[1] == 6) * areas[owners, None]
    return np.asarray(np.bincount(facets[owners].ravel(), shares.ravel(), len(points)), dtype=float)


def _inner(owners: IntArray, pieces: FloatArray, heights: FloatArray) -> tuple[IntArray, FloatArray]:
    """What is left of triangles (p, 3, 3) in barycentric coordinates of their owners (p,), cut at zero height.

    heights: (t, 3) of the owners' corners. A triangle with one vertex inside leaves one, with two inside two.
    """
    at = np.einsum("pvc,pc->pv", pieces, heights[owners])
    inside = np.count_nonzero(at >= 0.0, axis=1)
    whole, cut = inside == 3, (inside == 1) | (inside == 2)
    owner, piece, at, two = owners[cut], pieces[cut], at[cut], inside[cut] == 2
    lone = np.where(two, np.argmin(at, axis=1), np.argmax(at, axis=1))
    turn = (lone[:, None] + np.arange(3)) % 3
    a, b, c = np.take_along_axis(piece, turn[..., None], axis=1).transpose(1, 0, 2)
    p, q, r = np.take_along_axis(at, turn, axis=1).T
    ab, ac = a + (b - a) * (p / (p - q))[:, None], a + (c - a) * (p / (p - r))[:, None]
    left = [np.stack([a, ab, ac], axis=1)[~two], np.stack([ab, b, c], axis=1)[two], np.stack([ab, c, ac], axis=1)[two]]
    return (
        np.concatenate([owners[whole], owner[~two], owner[two], owner[two]]),
        np.concatenate([pieces[whole], *left]),
    )


def _integrals(pieces: FloatArray, quadratic: bool) -> FloatArray:
    """(p, 3 or 6): integrals of a facet's shape functions over pieces (p, 3, 3) of it, the facet's area being one."""
    places = MIDPOINTS @ pieces
    values = _quadratic(places) if quadratic else places
    return np.asarray(np.abs(np.linalg.det(pieces))[:, None] * values.mean(axis=1))


def _quadratic(places: FloatArray) -> FloatArray:
    """(.., 6): L_a (2 L_a - 1) of the corners, 4 L_a L_b of the mid-side nodes, at barycentric places (.., 3)."""
    return np.concatenate([places * (2.0 * places - 1.0), 4.0 * places * np.roll(places, -1, axis=-1)], axis=-1)
