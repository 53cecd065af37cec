"""Parts whose contact travels: which finite-element nodes it takes hold of at each station of the joint."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
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

CANDIDATES = 3  # modes that a part which awaits its joints is stored with, for the machine to choose from
SAME = 9  # decimals of a joint value [m] up to which two contacts are at one place

Contact = tuple[str, Travel]
"""The interface that travels, and how."""

logger = logging.getLogger("prs_model")


def travelling_interface(interfaces: Mapping[str, Interface], source: str) -> Contact | None:
    """The one interface that travels, if any. Raises PartFileError when there are several."""
    found = [(name, each.travel) for name, each in interfaces.items() if each.travel is not None]
    if len(found) > 1:
        names = ", ".join(name for name, _ in found)
        raise PartFileError(source, f"the interfaces {names} travel, a part may have one that does")
    return found[0] if found else None


def shift_of(travel: Travel, value: float) -> FloatArray:
    """How far (3,) [m] a travelling interface has moved when its joint stands at a value [m]."""
    direction = np.array(travel.along, dtype=float)
    return np.asarray(direction / np.linalg.norm(direction) * np.round(value, SAME))


def reduce_travelling(
    model: FiniteElementModel, interfaces: Mapping[str, Interface], settings: Settings, *, grounded: bool = False
) -> TravellingElement:
    """Reduce a part with one travelling interface, by the method its `travel` asks for.

    Raises PartFileError for interfaces that the part cannot offer, PhysicsError for a part in several pieces.
    """
    contact = _contact(model, interfaces)
    travel = contact[1]
    ties, moving = _ties_by_station(model, interfaces, settings, contact, travel.stations)
    _warn_of_gaps(model, ties[0], moving, np.array([shift_of(travel, value) for value in travel.stations]))
    warn_of_surprises(model, ties[0])
    elements, products = _reduced(model, ties, moving, settings, contact, grounded)
    return TravellingElement(travel.joint, np.array(travel.stations, dtype=float), elements, products)


def reduce_in_place(
    model: FiniteElementModel,
    interfaces: Mapping[str, Interface],
    settings: Settings,
    value: float,
    *,
    grounded: bool = False,
) -> SuperElement:
    """The same part with its contact where it is when its joint stands at a value [m], as if a station were there.

    Raises what `reduce_travelling` raises.
    """
    contact = _contact(model, interfaces)
    ties, moving = _ties_by_station(model, interfaces, settings, contact, [value])
    return _reduced(model, ties, moving, settings, contact, grounded)[0][0]


def _contact(model: FiniteElementModel, interfaces: Mapping[str, Interface]) -> Contact:
    found = travelling_interface(interfaces, model.source)
    if found is None:
        raise PartFileError(model.source, f"{model.name}: none of its interfaces travels")
    name, travel = found
    if not any(travel.along):
        raise PartFileError(model.source, f"interfaces.{name}.travel.along: found (0, 0, 0), expected a direction")
    return name, travel


def _reduced(
    model: FiniteElementModel,
    ties: list[list[Tie]],
    moving: list[bool],
    settings: Settings,
    contact: Contact,
    grounded: bool,
) -> tuple[tuple[SuperElement, ...], FloatArray | None]:
    """An element for each station, and the products of their bases where these are interpolated."""
    name, travel = contact
    if travel.method == "stations":
        return node_per_station(model, ties, moving, settings.modes, grounded), None
    if all(moving) and not grounded:
        raise PartFileError(
            model.source, f"interfaces.{name}: the part has no other interface and no ground to be held by; add one"
        )
    awaits = settings.method == "joint-loaded"
    basis, modes = (AWAITS_JOINTS, CANDIDATES) if awaits else ("craig-bampton", settings.modes)
    return reduction_per_station(model, ties, np.array(moving), modes, grounded, basis)


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
    contact: Contact,
    stations: Sequence[float],
) -> tuple[list[list[Tie]], list[bool]]:
    """All ties at every station, and which of them travel; the nodes of those that do are put on straight lines."""
    travelling, travel = contact
    shifts = np.array([shift_of(travel, value) for value in stations])
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
