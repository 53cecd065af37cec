"""A part in a few numbers that its designer knows by heart, so that a wrong unit or a wrong file is seen at once."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import plugins
from ..arrays import FloatArray
from ..errors import PrsError
from ..finite_elements import MassProperties
from ..readable import figure
from .box import corners_of
from .super_element import SuperElement
from .travelling import TravellingElement

HEAVIEST = 2.3e4  # kg/m^3, osmium in the box around the nodes
FASTEST = 2.0e4  # m/s: twice the length times the first free frequency; sound in diamond
LONGEST, MOST = 30.0, 1e6  # m, kg: of a part of a machine

logger = logging.getLogger("prs_model")


@dataclass(frozen=True, eq=False)
class Summary:
    """name; mass [kg], centre [m] and inertia [kg m^2] (None when grounded); size [m] of the box around the part.

    whole: the box holds the whole part, else only its nodes are known. nodes: positions [m] by name. fixed, free: first
    frequencies [Hz] with all nodes held and with none held, without the zeros of rigid motion; of a grounded part the
    latter are those of the part as it is held. surprises: sentences about figures that no part of that kind has.
    """

    name: str
    size: FloatArray
    whole: bool
    nodes: dict[str, FloatArray]
    coordinates: int
    modes: int
    grounded: bool
    properties: MassProperties | None
    fixed: FloatArray
    free: FloatArray
    surprises: tuple[str, ...]

    def as_dict(self) -> dict[str, Any]:
        """Plain numbers, in SI, for JSON."""
        known = self.properties
        return {
            "name": self.name,
            "coordinates": self.coordinates,
            "modes": self.modes,
            "grounded": self.grounded,
            "mass_kg": None if known is None else known.mass,
            "centre_m": None if known is None else known.centre.tolist(),
            "inertia_kg_m2": None if known is None else known.inertia.tolist(),
            "size_m": self.size.tolist(),
            "size_of": "part" if self.whole else "nodes",
            "nodes_m": {name: position.tolist() for name, position in self.nodes.items()},
            "fixed_frequencies_hz": self.fixed.tolist(),
            "free_frequencies_hz": self.free.tolist(),
            "surprises": list(self.surprises),
        }


def summarize(element: SuperElement, count: int = 6, points: FloatArray | None = None) -> Summary:
    """The figures of an element, with up to `count` fixed and free frequencies. Raises PrsError for an indefinite one.

    points: (p, 3) [m] of the whole part, where they are known; default: its box, its surface, and at least its nodes.
    """
    known = None if element.grounded else element.mass_properties()
    free = element.frequencies(max(1, count))
    size, whole = _size(element, points)
    return Summary(
        name=element.name,
        size=size,
        whole=whole,
        nodes=dict(zip(element.nodes, element.positions, strict=True)),
        coordinates=element.size,
        modes=element.n_modes,
        grounded=element.grounded,
        properties=known,
        fixed=element.frequencies(count, held=True),
        free=free[:count],
        surprises=tuple(_surprises(element, known, size, free, whole=whole)),
    )


def echo(element: SuperElement | TravellingElement, name: str, points: FloatArray | None = None) -> None:
    """Log mass, size and first frequency in SI, and a warning for each figure that no part of that kind has."""
    first = element if isinstance(element, SuperElement) else element.elements[0]
    try:
        summary = summarize(first, 1, points)
    except PrsError as error:
        logger.warning("%s: no figures: %s", name, error)
        return
    mass = "held to the ground" if summary.properties is None else f"{figure(summary.properties.mass)} kg"
    size = f"{'' if summary.whole else 'nodes '}in {' x '.join(map(figure, summary.size))} m"
    logger.info("%s: %s, %s%s", name, mass, size, _first_frequency(first, summary))
    for surprise in summary.surprises:
        logger.warning("%s: %s", name, surprise)


def _first_frequency(element: SuperElement, summary: Summary) -> str:
    if not summary.free.size:
        return ""
    kind = "held" if element.grounded else "free"
    tied = " with its interfaces tied" if reduced_here(element) else ""
    return f", first {kind} frequency {figure(summary.free[0])} Hz{tied}"


def reduced_here(element: SuperElement) -> bool:
    """Whether the element was made of full matrices, whose interfaces it ties: rigid ones stiffen the part."""
    return "full_dofs" in element.provenance


def _size(element: SuperElement, points: FloatArray | None) -> tuple[FloatArray, bool]:
    """Extent (3,) [m], and whether it is that of the whole part."""
    known = [each for each in (points, corners_of(element)) if each is not None]
    if element.surface is not None:
        known.append(element.surface.points)
    return np.asarray(np.ptp(np.vstack([element.positions, *known]), axis=0)), bool(known)


def _surprises(
    element: SuperElement, known: MassProperties | None, size: FloatArray, free: FloatArray, *, whole: bool
) -> Iterator[str]:
    """whole: the whole part is within `size`, not only its interface nodes."""
    longest, advice = float(size.max(initial=0.0)), _advice(element)
    if known is not None and whole and np.all(size > 1e-3 * longest) and known.mass > HEAVIEST * np.prod(size):
        yield f"{figure(known.mass)} kg within {np.prod(size):.3g} m^3 is denser than any metal; {advice}"
    reach = longest if known is not None else float(size.min(initial=np.inf)) if whole else 0.0
    if free.size and 2.0 * reach * free[0] > FASTEST:
        first = f"its first frequency, {'held' if element.grounded else 'free'}, {figure(free[0])} Hz,"
        yield f"{first} is too high for a part {figure(longest)} m long; {advice}"
    if 0.0 < longest < 1e-3 or (longest > LONGEST and not _is_in_si(element)):
        yield f"its nodes are {figure(longest)} m apart; {advice}"
    if known is not None and known.mass > MOST and not _is_in_si(element):
        yield f"it weighs {figure(known.mass)} kg; {advice}"


def _advice(element: SuperElement) -> str:
    reader = _reader(element)
    return "check 'units'" if reader is None or reader.needs_source else "check the units of its numbers"


def _is_in_si(element: SuperElement) -> bool:
    """Whether its file has no units but SI's: such a part may be a structure of any size."""
    reader = _reader(element)
    return reader is not None and reader.needs_source and reader.units == "SI"


def _reader(element: SuperElement) -> plugins.Reducer[Any] | None:
    try:
        return plugins.reducer(element.provenance.get("reducer", ""))
    except PrsError:  # made by hand, or stored by a plug-in that is no longer there
        return None
