"""Parts whose contact travels: which finite-element nodes it takes hold of at each station of the joint."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from ..arrays import FloatArray
from ..description.interface import Interface, Travel
from ..errors import PartFileError
from ..finite_elements import FiniteElementModel
from .contact import reduction_per_station
from .coupling import Tie
from .craig_bampton import craig_bampton
from .from_model import AWAITS_JOINTS, to_element
from .interfaces import interface_ties
from .recipe import Settings
from .super_element import SuperElement
from .surprising_ties import warn_of_surprises
from .travelling import TravellingElement

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
    ties, moving = _ties_by_station(model, interfaces, settings, name, shifts)
    _warn_of_gaps(model, ties[0], moving, shifts)
    warn_of_surprises(model, ties[0])
    if travel.method == "stations":
        nodes = node_per_station(model, ties, moving, settings.modes, grounded)
        return TravellingElement(travel.joint, stations, nodes)
    if all(moving) and not grounded:
        raise PartFileError(
            model.source, f"interfaces.{name}: the part has no other interface and no ground to be held by; add one"
        )
    basis = AWAITS_JOINTS if settings.method == "joint-loaded" else "craig-bampton"
    elements, products = reduction_per_station(model, ties, np.array(moving), settings.modes, grounded, basis)
    return TravellingElement(travel.joint, stations, elements, products)


def _warn_of_gaps(model: FiniteElementModel, ties: list[Tie], moving: list[bool], shifts: FloatArray) -> None:
    """A rigid contact that steps over more than its own length leaves stretches of the part that it never touches."""
    steps = np.linalg.norm(np.diff(shifts, axis=0), axis=1)
    direction = (shifts[-1] - shifts[0]) / np.linalg.norm(shifts[-1] - shifts[0])
    for tie, moves in zip(ties, moving, strict=True):
        length = float(np.ptp(model.coordinates[tie.indices] @ direction))
        if moves and tie.coupling == "rigid" and steps.max() > length * (1.0 + 1e-6):
            logger.warning(
                "%s: stations of %s are up to %.4g m apart, its rigid contact is %.4g m long; use closer stations",
                *(model.name, tie.node, steps.max(), length),
            )


def _ties_by_station(
    model: FiniteElementModel,
    interfaces: Mapping[str, Interface],
    settings: Settings,
    travelling: str,
    shifts: FloatArray,
) -> tuple[list[list[Tie]], list[bool]]:
    """All ties at every station, and which of them travel; the nodes of those that do are put on straight lines."""
    ties = [interface_ties(model, interfaces, settings, shift=shift) for shift in shifts]
    one = interface_ties(model, {travelling: interfaces[travelling]}, settings, shift=shifts[0])
    names = {tie.node for tie in one}
    moving = [tie.node in names for tie in ties[0]]
    positions = np.array([[tie.position for tie in station] for station in ties])
    starts = np.mean(positions - shifts[:, None, :], axis=0)
    for station, shift in zip(ties, shifts, strict=True):
        for j in np.flatnonzero(moving):
            station[j] = replace(station[j], position=starts[j] + shift)
    return ties, moving


def node_per_station(
    model: FiniteElementModel, ties: list[list[Tie]], moving: list[bool], n_modes: int, grounded: bool
) -> tuple[SuperElement, ...]:
    """Method ``stations``: one reduction with nodes ``<node>@<k>``; the travelling node is station k's there."""
    fixed = [tie for tie, moves in zip(ties[0], moving, strict=True) if not moves]
    held = [
        replace(tie, node=f"{tie.node}@{k}")
        for k, station in enumerate(ties, start=1)
        for tie, moves in zip(station, moving, strict=True)
        if moves
    ]
    whole = to_element(model, [*fixed, *held], craig_bampton(model, [*fixed, *held], n_modes), grounded=grounded)
    names, kept = tuple(tie.node for tie in ties[0]), tuple(tie.node for tie in held)
    elements = []
    for k in range(1, len(ties) + 1):
        here = [f"{name}@{k}" if moves else name for name, moves in zip(names, moving, strict=True)]
        source = [whole.node(name) for name in (*here, *kept)]
        elements.append(
            replace(whole, nodes=(*names, *kept), positions=whole.positions[source], motions=whole.motions[source])
        )
    return tuple(elements)
