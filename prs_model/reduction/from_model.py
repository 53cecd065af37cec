"""A finite-element model and its interfaces become a super-element."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from ..description.schema import Interface
from ..errors import PartFileError
from ..finite_elements import FiniteElementModel
from .coupling import Tie
from .craig_bampton import Reduction, craig_bampton
from .interfaces import interface_ties
from .recipe import Settings
from .super_element import SuperElement, node_labels
from .surface import decimate

FloatArray = NDArray[np.float64]


def reduce_model(
    model: FiniteElementModel, interfaces: Mapping[str, Interface], settings: Settings, *, grounded: bool = False
) -> SuperElement:
    """Craig-Bampton reduction of a part to its interfaces.

    Raises PartFileError for interfaces that the part cannot offer, PhysicsError for a part in several pieces.
    """
    if not interfaces:
        raise PartFileError(
            model.source, f"{model.name} has no interfaces: name at least one, to join the part to others"
        )
    ties = interface_ties(model, interfaces, settings)
    return to_element(model, ties, craig_bampton(model, ties, settings.modes), grounded=grounded)


def to_element(
    model: FiniteElementModel,
    ties: Sequence[Tie],
    reduction: Reduction,
    *,
    grounded: bool,
    change: FloatArray | None = None,
) -> SuperElement:
    """A reduction as a super-element: six coordinates per tie, which are its motion, then the modes.

    change: C (n, n), where other coordinates v with u = C v are wanted; they keep the labels of u.
    """
    n, p = reduction.basis.shape[1], reduction.n_modes
    change = np.eye(n) if change is None else change
    labels = [label for tie in ties for label in node_labels(tie.node)]
    return SuperElement(
        stiffness=_congruent(reduction.stiffness, change),
        mass=_congruent(reduction.mass, change),
        nodes=tuple(tie.node for tie in ties),
        positions=np.array([tie.position for tie in ties]),
        motions=change[: n - p].reshape(len(ties), 6, n),
        n_modes=p,
        grounded=grounded,
        surface=decimate(model, reduction.basis @ change),
        labels=(*labels, *(f"mode {i + 1}" for i in range(p))),
        provenance={**model.provenance, "modes": "fixed-interface", "full_dofs": str(model.size)},
    )


def _congruent(matrix: FloatArray, change: FloatArray) -> FloatArray:
    product = change.T @ matrix @ change
    return np.asarray((product + product.T) / 2.0)
