"""Parts whose contact travels: one reduction per station of the joint, in coordinates that mean the same at each."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from ..description.schema import Interface, Travel
from ..errors import PartFileError
from ..finite_elements import FiniteElementModel
from ..finite_elements.rigid_motion import transfer
from .coupling import Tie
from .craig_bampton import Reduction, craig_bampton
from .from_model import to_element
from .interfaces import interface_ties
from .recipe import Settings
from .super_element import SuperElement
from .travelling import TravellingElement

FloatArray = NDArray[np.float64]

logger = logging.getLogger("prs_model")


def travelling_interface(interfaces: Mapping[str, Interface], source: str) -> tuple[str, Travel] | None:
    """The one interface that travels, if any. Raises PartFileError when there are several."""
    found = [(name, each.travel) for name, each in interfaces.items() if each.travel is not None]
    if len(found) > 1:
        names = ", ".join(name for name, _ in found)
        raise PartFileError(source, f"the interfaces {names} travel, a part may have one that does")
    return found[0] if found else None


def reduce_travelling(
    model: FiniteElementModel, interfaces: Mapping[str, Interface], settings: Settings, *, grounded: bool = False
) -> TravellingElement:
    """Reduce a part with one travelling interface, by the method its `travel` asks for.

    Raises PartFileError for interfaces that the part cannot offer, PhysicsError for a part in several pieces.
    """
    found = travelling_interface(interfaces, model.source)
    if found is None:
        raise PartFileError(model.source, f"{model.name}: none of its interfaces travels")
    name, travel = found
    direction = np.array(travel.along, dtype=float)
    if not np.any(direction):
        raise PartFileError(model.source, f"interfaces.{name}.travel.along: found (0, 0, 0), expected a direction")
    stations = np.array(travel.stations, dtype=float)
    shifts = np.outer(stations, direction / np.linalg.norm(direction))
    fixed, moving = _ties_by_station(model, interfaces, settings, name, shifts)
    build = _one_reduction_per_station if travel.method == "reduced" else _one_node_per_station
    elements = build(model, fixed, moving, settings.modes, grounded)
    return TravellingElement(travel.joint, stations, elements)


def _ties_by_station(
    model: FiniteElementModel,
    interfaces: Mapping[str, Interface],
    settings: Settings,
    travelling: str,
    shifts: FloatArray,
) -> tuple[list[Tie], list[list[Tie]]]:
    """Ties that stay, and the travelling interface's ties at every station, their nodes on straight lines."""
    others = {name: each for name, each in interfaces.items() if name != travelling}
    moving = [interface_ties(model, {travelling: interfaces[travelling]}, settings, shift=shift) for shift in shifts]
    origins = np.mean(
        [[tie.position - shift for tie in ties] for ties, shift in zip(moving, shifts, strict=True)], axis=0
    )
    straight = [
        [replace(tie, position=origin + shift) for tie, origin in zip(ties, origins, strict=True)]
        for ties, shift in zip(moving, shifts, strict=True)
    ]
    return interface_ties(model, others, settings), straight


def _one_reduction_per_station(
    model: FiniteElementModel, fixed: list[Tie], moving: list[list[Tie]], n_modes: int, grounded: bool
) -> tuple[SuperElement, ...]:
    """Method ``reduced``: travelling coordinates refer to one point r_0 of the body, modes follow the last station's.

    Motion of the node at station k: X(r_k - r_0) U, so a rigid motion has the same coordinates at every station.
    """
    references = np.mean([[tie.position for tie in ties] for ties in moving], axis=0)
    elements: list[SuperElement] = []
    previous: FloatArray | None = None
    for index, ties in enumerate(moving):
        logger.info("%s: station %d of %d", model.name, index + 1, len(moving))
        reduction = craig_bampton(model, [*fixed, *ties], n_modes)
        arms = np.array([tie.position for tie in ties]) - references
        change = _change(reduction, len(fixed), arms, _aligned(model, reduction, previous))
        elements.append(to_element(model, [*fixed, *ties], reduction, grounded=grounded, change=change))
        previous = (reduction.basis @ change)[:, reduction.basis.shape[1] - n_modes :]
    return tuple(elements)


def _change(reduction: Reduction, n_fixed: int, arms: FloatArray, rotation: FloatArray) -> FloatArray:
    """C = diag(1, X(arm) .., Q): from coordinates that mean the same at every station to the reduction's own."""
    n = reduction.basis.shape[1]
    change = np.eye(n)
    for j, block in enumerate(transfer(arms), start=n_fixed):
        change[6 * j : 6 * j + 6, 6 * j : 6 * j + 6] = block
    change[n - reduction.n_modes :, n - reduction.n_modes :] = rotation
    return change


def _aligned(model: FiniteElementModel, reduction: Reduction, previous: FloatArray | None) -> FloatArray:
    """Q (p, p), orthogonal: min |Phi Q - Phi_previous| in the mass inner product (Procrustes)."""
    p = reduction.n_modes
    if previous is None or p == 0:
        return np.eye(p)
    modes = reduction.basis[:, reduction.basis.shape[1] - p :]
    left, likeness, right = np.linalg.svd(modes.T @ (model.mass @ previous))
    if likeness[-1] < 0.5:
        logger.warning(
            "%s: its fixed-interface modes change between two stations (likeness %.2f of 1); "
            "use closer stations or another number of modes",
            model.name,
            likeness[-1],
        )
    return np.asarray(left @ right)


def _one_node_per_station(
    model: FiniteElementModel, fixed: list[Tie], moving: list[list[Tie]], n_modes: int, grounded: bool
) -> tuple[SuperElement, ...]:
    """Method ``stations``: one reduction with nodes ``<node>@<k>``; the travelling node is station k's there."""
    named = [[replace(tie, node=f"{tie.node}@{k}") for tie in ties] for k, ties in enumerate(moving, start=1)]
    ties = [*fixed, *(tie for station in named for tie in station)]
    whole = to_element(model, ties, craig_bampton(model, ties, n_modes), grounded=grounded)
    nodes = tuple(tie.node for tie in moving[0])
    elements = []
    for station in named:
        here = [whole.node(tie.node) for tie in station]
        elements.append(
            replace(
                whole,
                nodes=(*whole.nodes[: len(fixed)], *nodes, *whole.nodes[len(fixed) :]),
                positions=np.insert(whole.positions, len(fixed), whole.positions[here], axis=0),
                motions=np.insert(whole.motions, len(fixed), whole.motions[here], axis=0),
            )
        )
    return tuple(elements)
