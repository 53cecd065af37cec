"""The static shapes of a part under its joints, and coordinates made of such shapes.

The part (K, M) is held by springs K_s at its ends D_s u, whose other ends follow the bodies beyond. When these move
rigidly by xi, so that a spring's far end moves by X_s xi, the part takes the static shapes

    V = (K + sum D_s^T K_s D_s)^-1 sum D_s^T K_s X_s

six for each joint. All bodies beyond may move as one, so the part's own rigid motions are among them.
"""

from __future__ import annotations

import numpy as np

from ..arrays import FloatArray
from .held import Held

REPEATED = 1e-9  # of the largest energy: what remains of a shape that others make up
STRAINED = 1e-8  # of a shape's energy in the norm of `energy_matrix`


def static_shapes(part: Held) -> FloatArray:
    """(n, 6 p): a part's shapes when what lies beyond its joints moves rigidly, for each of its p grips.

    Twists are about the body's origin [m, rad]. What the joints do not pass on is zero.
    """
    moved = [part.following(grip, grip.beyond) for grip in part.grips]
    return np.hstack([np.zeros((part.element.size, 0)), *moved])


def shapes_under_loads(part: Held) -> FloatArray:
    """(n, 6 k): shapes under unit loads on the k nodes that no joint takes hold of."""
    touched = {node for grip in part.grips for node in grip.nodes}
    loads = [part.element.motions[node].T for node in range(len(part.element.nodes)) if node not in touched]
    return np.hstack([np.zeros((part.element.size, 0)), *(part.under(load) for load in loads)])


def energy_matrix(part: Held, static: FloatArray) -> FloatArray:
    """K + g sum D_j^T D_j over the nodes (n, n), g as stiff as the joints are.

    In this norm a rigid motion is the smallest of all that have its node motions, since K holds no rigid motion: so
    coordinates orthonormal in it give the rigid-body modes of an element their meaning.
    """
    element = part.element
    size = float(np.linalg.norm(np.ptp(element.positions, axis=0))) or 1.0
    motions = element.motions * np.array([1.0, 1.0, 1.0, size, size, size])[:, None]
    nodes = np.einsum("jai,jab->ib", motions, motions, optimize=True)
    moved = float(np.sum(energies(nodes, static)))
    stiffness = float(np.sum(energies(part.stiffness, static))) / moved if moved > 0.0 else 0.0
    return np.asarray(element.stiffness + (stiffness or 1.0) * nodes)


def independent(energy: FloatArray, shapes: FloatArray) -> FloatArray:
    """(c, r): combinations of shapes (n, c) that are orthonormal in an energy (n, n); repeated ones are left out."""
    overlap = shapes.T @ energy @ shapes
    weight, combination = np.linalg.eigh((overlap + overlap.T) / 2.0)
    apart = weight > REPEATED * weight.max(initial=0.0)
    return np.asarray(combination[:, apart] / np.sqrt(weight[apart]))


def equal_in_energy(energy: FloatArray, shapes: FloatArray, patterns: int) -> FloatArray:
    """Factors (c,) on shapes (n, c): one on the static shapes, the first 6 `patterns`, that makes the largest a unit of
    energy; on each of the others what makes it one; zero on shapes without energy.
    """
    own = energies(energy, shapes)
    own[: 6 * patterns] = own[: 6 * patterns].max(initial=0.0)
    return np.divide(1.0, np.sqrt(own), out=np.zeros_like(own), where=own > 0.0)


def rigid_and_elastic(
    part: Held, energy: FloatArray, shapes: FloatArray, patterns: int
) -> tuple[FloatArray, FloatArray]:
    """Combinations (c, r) of shapes (n, c): the part's rigid motions, if it is free, and independent ones besides.

    The first 6 `patterns` of them are static shapes. All that lies beyond a free part's joints, moving as one, moves it
    rigidly.
    """
    together = np.zeros((shapes.shape[1], 6))
    together[: 6 * patterns] = np.tile(np.eye(6), (patterns, 1))
    moved = shapes @ together
    strained = energies(part.element.stiffness, moved) > STRAINED * energies(energy, moved)
    if part.element.grounded or np.any(strained):
        return together[:, :0], independent(energy, shapes)
    overlap = shapes.T @ energy @ shapes
    share = np.linalg.solve(together.T @ overlap @ together, together.T @ overlap)
    others = np.eye(shapes.shape[1]) - together @ share
    return together, others @ independent(energy, shapes @ others)


def energies(matrix: FloatArray, shapes: FloatArray) -> FloatArray:
    """u^T A u (c,) of each shape (n, c)."""
    return np.asarray(np.einsum("ij,ij->j", shapes, matrix @ shapes))
