"""A part read by its reducer, reduced to its interfaces, and past the physics gate."""

from __future__ import annotations

import logging
from collections.abc import Mapping
from dataclasses import dataclass, replace

from .. import plugins
from ..description.schema import Body
from ..description.section import Section
from ..errors import PartFileError
from ..finite_elements import FiniteElementModel
from .from_model import reduce_model
from .model_gate import check_model
from .recipe import Settings
from .retained import at_interfaces
from .stations import reduce_travelling, travelling_interface
from .store import Element
from .super_element import SuperElement
from .travelling import TravellingElement

logger = logging.getLogger("prs_model")


@dataclass(frozen=True, eq=False)
class MadePart:
    """An element, and whether the reduction was ours, so that storing it saves work."""

    element: Element
    reduced_here: bool


def make_part(
    request: plugins.PartRequest[Section], body: Body, settings: Settings, made_from: Mapping[str, str]
) -> MadePart:
    """Read, reduce, check. made_from: what its provenance says of its files and recipe.

    Raises PluginError for a reducer that fails, PartFileError, or PhysicsError for what is no part.
    """
    part = plugins.read(body.reducer, request)
    place = str(request.source or request.name)
    full = isinstance(part, FiniteElementModel)
    element = (
        _from_model(part, body, settings, request.name, place)
        if isinstance(part, FiniteElementModel)
        else _as_reduced(part, body, settings, place)
    )
    element = _stamped(element, {"name": request.name, "reducer": body.reducer, **made_from})
    element.check()
    return MadePart(element, full)


def checked_model(model: FiniteElementModel, body: Body, name: str, place: str) -> FiniteElementModel:
    """Full matrices past the physics gate, with what the body clamps held. Raises PartFileError or PhysicsError."""
    model = replace(model, provenance={**model.provenance, "name": name, "source": place})
    check_model(model, grounded=body.grounded, clamped=bool(body.clamped))
    return model.clamp(body.clamped) if body.clamped else model


def _as_reduced(element: SuperElement, body: Body, settings: Settings, place: str) -> SuperElement:
    full_only = {"modes": body.modes is not None, "clamped": bool(body.clamped)}
    for entry, given in full_only.items():
        if given:
            raise PartFileError(place, f"{entry}: the part is already reduced, and keeps what it has; remove '{entry}'")
    element = replace(element, grounded=element.grounded or body.grounded)
    return at_interfaces(element, body.interfaces, replace(settings, method="craig-bampton"), place)


def _from_model(model: FiniteElementModel, body: Body, settings: Settings, name: str, place: str) -> Element:
    model = checked_model(model, body, name, place)
    logger.info("%s: reducing %d DOFs", model.name, model.size)
    travels = travelling_interface(body.interfaces, place) is not None
    return (reduce_travelling if travels else reduce_model)(model, body.interfaces, settings, grounded=body.grounded)


def _stamped(element: Element, more: Mapping[str, str]) -> Element:
    if isinstance(element, TravellingElement):
        stations = (replace(each, provenance={**each.provenance, **more}) for each in element.elements)
        return replace(element, elements=tuple(stations))
    return replace(element, provenance={**element.provenance, **more})
