"""Which mode of one model answers which of another, and how alike they are: the modal assurance criterion (eq. 23).

Shapes are compared on what two models of a body have in common: the translations, in body axes, of the points of its
picture surface, where both have the same; otherwise of the nodes that both models name.
"""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment

from ..arrays import FloatArray, IntArray
from ..errors import PrsError, short
from .clusters import GAP, clusters, groups
from .modes import Modes

if TYPE_CHECKING:
    from ..complete_order import CompleteModes
    from ..reduction import SuperElement
    from ..response import ComplexModes

    AnyModes = Modes | ComplexModes | CompleteModes
    Shapes = NDArray[np.inexact[Any]]

_ALIKE = 1e-4  # of a body's size: how far points that are one may lie apart
_log = logging.getLogger("prs_model")


@dataclass(frozen=True, eq=False)
class BodyShapes:
    """Translations of a body in body axes: of points (p, 3) of its surface (3 p, k), if it has one, and of its nodes
    (3, k) by their names."""

    points: FloatArray | None
    surface: Shapes
    nodes: Mapping[str, Shapes]


Observation = Mapping[str, BodyShapes]
"""Shapes by the bodies they are of."""


def mac(modes_a: AnyModes, modes_b: AnyModes) -> FloatArray:
    """The modal assurance criterion (n_a, n_b) between the modes of two models, eq. (23); 1 is the same shape.

    Modes, complex modes (with |a^H b|^2 in the numerator) and those of the complete order, each with each. Modes of
    equal frequency are known again by `pair_modes` only. Bodies that cannot be compared are left out with a warning.
    Raises PrsError when the models have nothing in common that could be compared, or for what are no modes.
    """
    return mac_of(*in_common(observe(modes_a), observe(modes_b)))


def pair_modes(modes_a: AnyModes, modes_b: AnyModes, gap: float = GAP) -> Pairing:
    """Which mode of model b each mode of model a is, and how alike they are; see Pairing.

    gap: modes closer than this share of their frequency may have turned into each other, and are then compared as the
    plane that they span. Give b some more modes than a: a partner may have moved up.
    Raises PrsError as `mac` does, and when b has fewer modes than a.
    """
    shapes_a, shapes_b = in_common(observe(modes_a), observe(modes_b))
    if shapes_a.shape[1] > shapes_b.shape[1]:
        raise PrsError(
            f"found {shapes_a.shape[1]} modes to pair with {shapes_b.shape[1]}, expected as many at least; ask the "
            "second model for more"
        )
    return pairing(shapes_a, shapes_b, modes_a.frequencies, modes_b.frequencies, gap)


def observe(modes: AnyModes) -> Observation:
    """What there is to compare of each body. Raises PrsError for what are no modes."""
    from ..complete_order import CompleteModes
    from ..response import ComplexModes

    if isinstance(modes, CompleteModes):
        modes = modes.modes
    if not isinstance(modes, Modes | ComplexModes):
        raise PrsError(f"found {short(repr(modes))}, expected modes, such as machine.modes(8)")
    system = modes.system
    return {
        name: _body_shapes(element, system.expansion[system.blocks[name]] @ modes.shapes)
        for name, element in system.elements.items()
    }


def _body_shapes(element: SuperElement, shapes: Shapes) -> BodyShapes:
    nodes = zip(element.nodes, element.motions, strict=True)
    points, surface = None, shapes[:0]
    if element.surface is not None:
        points = element.surface.points
        surface = element.surface.recovery.reshape(-1, element.size).astype(float) @ shapes
    return BodyShapes(points, surface, {node: motion[:3] @ shapes for node, motion in nodes})


def in_common(a: Observation, b: Observation) -> tuple[Shapes, Shapes]:
    """The rows that two models both have, stacked (r, n_a) and (r, n_b). Raises PrsError when there are none.

    Of each body the points of its surface, where both have the same, otherwise the nodes that both name.
    """
    rows = {body: _rows_in_common(a[body], b[body]) for body in a if body in b}
    found = [pair for pair in rows.values() if len(pair[0])]
    if not found:
        raise PrsError(
            "the two models have no surface points and no nodes in common, so that their mode shapes cannot be "
            "compared; expected two models of one machine"
        )
    left_out = [body for body in {**a, **b} if body not in rows or not len(rows[body][0])]
    if left_out:
        _log.warning("shapes are compared without %s: no points or nodes in common", ", ".join(left_out))
    return np.vstack([pair[0] for pair in found]), np.vstack([pair[1] for pair in found])


def _rows_in_common(a: BodyShapes, b: BodyShapes) -> tuple[Shapes, Shapes]:
    if a.points is not None and b.points is not None and _same_points(a.points, b.points):
        return a.surface, b.surface
    both = [node for node in a.nodes if node in b.nodes]
    empty = a.surface[:0], b.surface[:0]
    return np.vstack([empty[0], *(a.nodes[n] for n in both)]), np.vstack([empty[1], *(b.nodes[n] for n in both)])


def _same_points(a: FloatArray, b: FloatArray) -> bool:
    return a.shape == b.shape and bool(np.abs(a - b).max(initial=0.0) <= _ALIKE * np.ptp(a, axis=0).max(initial=0.0))


def mac_of(a: Shapes, b: Shapes) -> FloatArray:
    """|a_i^H b_j|^2 / (a_i^H a_i)(b_j^H b_j) of shapes (r, n_a) and (r, n_b), eq. (23); 0 where a shape is zero."""
    sizes = np.outer((np.abs(a) ** 2).sum(axis=0), (np.abs(b) ** 2).sum(axis=0))
    return np.asarray(np.abs(a.conj().T @ b) ** 2 / np.where(sizes > 0.0, sizes, 1.0))


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
    shapes_a: Shapes,
    shapes_b: Shapes,
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
    partners = linear_sum_assignment(np.maximum(there, back), maximize=True)[1]
    numbers = _either(clusters(frequencies_a, gap), clusters(frequencies_b, gap)[partners])
    for some in groups(numbers):
        partners[some] = np.sort(partners[some])
    turned = shapes_b[:, partners].astype(np.result_type(shapes_a, shapes_b))
    for some in groups(numbers):
        left, _, right = np.linalg.svd(turned[:, some].conj().T @ shapes_a[:, some])
        turned[:, some] = turned[:, some] @ (left @ right)
    return Pairing(partners, numbers, mac_of(shapes_a, turned))


def subspace_mac(a: Shapes, b: Shapes, numbers: IntArray) -> FloatArray:
    """(n_a, n_b): the squared cosine between a mode of a and the nearest shape in the cluster of a mode of b.

    Equal to the MAC where the clusters `numbers` (n_b,) have one mode each.
    """
    result = np.empty((a.shape[1], b.shape[1]))
    size = (np.abs(a) ** 2).sum(axis=0)
    for some in groups(numbers):
        basis = np.linalg.qr(b[:, some])[0]
        share = (np.abs(basis.conj().T @ a) ** 2).sum(axis=0) / np.where(size > 0.0, size, 1.0)
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
