"""Which mode of one model answers which of another, and how alike they are: the modal assurance criterion (eq. 23).

Shapes are compared on what any two models of one part have in common: the translations, in body axes, of the points of
its picture surface; of a part without one, the translations of the nodes that both models name.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from scipy.optimize import linear_sum_assignment

from ..arrays import FloatArray, IntArray
from ..errors import PrsError
from .clusters import GAP, clusters, groups
from .modes import Modes

if TYPE_CHECKING:
    from ..complete_order import CompleteModes

Observation = Mapping[str, FloatArray]
"""Shapes (rows, k) by what is observed: a body's surface, or one of its nodes."""


def mac(modes_a: Modes | CompleteModes, modes_b: Modes | CompleteModes) -> FloatArray:
    """The modal assurance criterion (n_a, n_b) between the modes of two models, eq. (23); 1 is the same shape.

    Raises PrsError when the models have nothing in common that could be compared.
    """
    return mac_of(*in_common(observe(modes_a), observe(modes_b)))


def observe(modes: Modes | CompleteModes) -> Observation:
    """Translations of every body's surface points (3 p, k) in body axes; of its nodes where it has no surface."""
    if not isinstance(modes, Modes):
        modes = modes.modes
    seen: dict[str, FloatArray] = {}
    for body, element in modes.system.elements.items():
        shapes = modes.body_shapes(body)
        if element.surface is not None:
            seen[f"{body} surface"] = element.surface.recovery.reshape(-1, element.size).astype(float) @ shapes
        else:
            nodes = zip(element.nodes, element.motions, strict=True)
            seen |= {f"{body} node {node}": motion[:3] @ shapes for node, motion in nodes}
    return seen


def in_common(a: Observation, b: Observation) -> tuple[FloatArray, FloatArray]:
    """The rows that two models both have, stacked (r, n_a) and (r, n_b). Raises PrsError when there are none."""
    both = [key for key in a if key in b and len(a[key]) == len(b[key])]
    if not both:
        raise PrsError(
            "the two models have no surface points and no nodes in common, so that their mode shapes cannot be "
            "compared; expected two models of one machine"
        )
    return np.vstack([a[key] for key in both]), np.vstack([b[key] for key in both])


def mac_of(a: FloatArray, b: FloatArray) -> FloatArray:
    """(a_i^T b_j)^2 / (a_i^T a_i)(b_j^T b_j) of shapes (r, n_a) and (r, n_b), eq. (23); 0 where a shape is zero."""
    sizes = np.outer((a**2).sum(axis=0), (b**2).sum(axis=0))
    return np.asarray((a.T @ b) ** 2 / np.where(sizes > 0.0, sizes, 1.0))


def pair_modes(likeness: FloatArray) -> IntArray:
    """The mode of b (n_a,) that each of a goes with, all different, the sum of `likeness` (n_a, n_b >= n_a) largest."""
    return np.asarray(linear_sum_assignment(likeness, maximize=True)[1])


@dataclass(frozen=True, eq=False)
class Pairing:
    """Modes of model a, and what answers them in model b.

    partners (n,): the mode of b that each mode of a goes with. clusters (n,): equal for modes that are too close to be
    told apart. mac (n, n): eq. (23) with the partners in order, those of one cluster turned to match.
    """

    partners: IntArray
    clusters: IntArray
    mac: FloatArray


def pairing(
    shapes_a: FloatArray,
    shapes_b: FloatArray,
    frequencies_a: FloatArray,
    frequencies_b: FloatArray,
    gap: float = GAP,
) -> Pairing:
    """Pair mass-normalised shapes (r, n_a) with shapes (r, n_b >= n_a) on the same rows; frequencies ascend.

    Any combination of modes of equal frequency is a mode too. Pairs are therefore sought between a mode and the nearest
    shape in the other's cluster; within a cluster they follow the order of frequencies, and the shapes of b are turned
    by the orthogonal matrix that brings them nearest to those of a (Procrustes).
    """
    there = subspace_mac(shapes_a, shapes_b, clusters(frequencies_b, gap))
    back = subspace_mac(shapes_b, shapes_a, clusters(frequencies_a, gap)).T
    partners = pair_modes(np.maximum(there, back))
    numbers = _either(clusters(frequencies_a, gap), clusters(frequencies_b, gap)[partners])
    for some in groups(numbers):
        partners[some] = np.sort(partners[some])
    turned = shapes_b[:, partners]
    for some in groups(numbers):
        left, _, right = np.linalg.svd(turned[:, some].T @ shapes_a[:, some])
        turned[:, some] = turned[:, some] @ (left @ right)
    return Pairing(partners, numbers, mac_of(shapes_a, turned))


def subspace_mac(a: FloatArray, b: FloatArray, numbers: IntArray) -> FloatArray:
    """(n_a, n_b): the squared cosine between a mode of a and the nearest shape in the cluster of a mode of b.

    Equal to the MAC where the clusters `numbers` (n_b,) have one mode each.
    """
    result = np.empty((a.shape[1], b.shape[1]))
    size = (a**2).sum(axis=0)
    for some in groups(numbers):
        basis = np.linalg.qr(b[:, some])[0]
        share = ((basis.T @ a) ** 2).sum(axis=0) / np.where(size > 0.0, size, 1.0)
        result[:, some] = share[:, None]
    return result


def _either(a: IntArray, b: IntArray) -> IntArray:
    """Cluster numbers (n,) of pairs: two share one that are in one cluster in either model."""
    numbers = np.arange(len(a))
    for labels in (a, b):
        for label in np.unique(labels):
            joined = np.unique(numbers[labels == label])
            numbers[np.isin(numbers, joined)] = joined[0]
    return np.unique(numbers, return_inverse=True)[1]
