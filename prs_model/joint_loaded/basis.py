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


def equal_in_energy(energy: FloatArray, static: FloatArray, others: FloatArray) -> FloatArray:
    """Factors (c,) on static shapes and others, in this order: one on all static shapes, that makes the largest a unit
    of energy; on each of the others what makes it one; zero on shapes without energy.
    """
    own = energies(energy, static)
    size = np.concatenate([np.full(len(own), own.max(initial=0.0)), energies(energy, others)])
    return np.asarray(np.divide(1.0, np.sqrt(size), out=np.zeros_like(size), where=size > 0.0))


def apart_from(energy: FloatArray, first: FloatArray, shapes: FloatArray) -> FloatArray:
    """Combinations (k + c, r) of first shapes (n, k) and others (n, c): independent, and orthogonal to the first."""
    columns = np.hstack([first, shapes])
    share = np.linalg.lstsq(first.T @ energy @ first, first.T @ energy @ columns, rcond=None)[0]
    others = np.eye(columns.shape[1])
    others[: first.shape[1]] -= share
    return others @ independent(energy, columns @ others)


def energies(matrix: FloatArray, shapes: FloatArray) -> FloatArray:
    """u^T A u (c,) of each shape (n, c)."""
    return np.asarray(np.einsum("ij,ij->j", shapes, matrix @ shapes))
