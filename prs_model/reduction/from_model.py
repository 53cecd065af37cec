"""A finite-element model and its interfaces become a super-element."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from ..arrays import FloatArray
from ..description.schema import Interface
from ..errors import PartFileError
from ..finite_elements import FiniteElementModel
from ..finite_elements.rigid_motion import transfer
from .box import ENTRY as BOX
from .box import box_text
from .coupling import Tie
from .craig_bampton import Reduction, craig_bampton, ritz_craig_bampton
from .interfaces import interface_ties
from .recipe import Settings
from .super_element import SuperElement, node_labels
from .surface import decimate
from .surprising_ties import warn_of_surprises

AWAITS_JOINTS = "awaits joints"


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
    warn_of_surprises(model, ties)
    if settings.method == "joint-loaded":
        return to_element(model, ties, ritz_craig_bampton(model, ties), grounded=grounded, basis=AWAITS_JOINTS)
    return to_element(model, ties, craig_bampton(model, ties, settings.modes), grounded=grounded)


def to_element(
    model: FiniteElementModel,
    ties: Sequence[Tie],
    reduction: Reduction,
    *,
    grounded: bool,
    arms: FloatArray | None = None,
    modes: str = "fixed-interface",
    basis: str = "craig-bampton",
) -> SuperElement:
    """A reduction as a super-element: six coordinates per tie, then the modes, of the kind `modes`.

    arms: (k, 3) [m] from the point whose motion the coordinates of a tie are to its node; default zero.
    """
    n, p, k = reduction.basis.shape[1], reduction.n_modes, len(ties)
    selectors = np.eye(n)[: 6 * k].reshape(k, 6, n)
    labels = [label for tie in ties for label in node_labels(tie.node)]
    return SuperElement(
        stiffness=reduction.stiffness,
        mass=reduction.mass,
        nodes=tuple(tie.node for tie in ties),
        positions=np.array([tie.position for tie in ties]),
        motions=selectors if arms is None else transfer(arms) @ selectors,
        n_modes=p,
        grounded=grounded,
        surface=decimate(model, reduction.basis),
        labels=(*labels, *(f"mode {i + 1}" for i in range(p))),
        provenance={
            **model.provenance,
            "modes": modes,
            "basis": basis,
            "full_dofs": str(model.size),
            BOX: box_text(model.coordinates),
        },
    )
