"""A part in a few numbers that its designer knows by heart, so that a wrong unit or a wrong file is seen at once."""

from __future__ import annotations

import logging
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError
from ..finite_elements import MassProperties
from .super_element import SuperElement
from .travelling import TravellingElement

HEAVIEST = 2.3e4  # kg/m^3, osmium in the box around the nodes
FASTEST = 2.0e4  # m/s: twice the length times the first free frequency; sound in diamond
LONGEST = 30.0  # m

logger = logging.getLogger("prs_model")


@dataclass(frozen=True, eq=False)
class Summary:
    """name; mass [kg], centre [m] and inertia [kg m^2] (None when grounded); size [m] of the box around the nodes.

    nodes: positions [m] by name. fixed, free: first frequencies [Hz] with all nodes held and with none held, without
    the zeros of rigid motion. surprises: sentences about figures that no part of that kind has.
    """

    name: str
    size: FloatArray
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
            "nodes_m": {name: position.tolist() for name, position in self.nodes.items()},
            "fixed_frequencies_hz": self.fixed.tolist(),
            "free_frequencies_hz": self.free.tolist(),
            "surprises": list(self.surprises),
        }


def summarize(element: SuperElement, count: int = 6, points: FloatArray | None = None) -> Summary:
    """The figures of an element, with up to `count` fixed and free frequencies. Raises PrsError for an indefinite one.

    points: (p, 3) [m] of the whole part, where they are known; default: the surface's and the nodes'.
    """
    known = None if element.grounded else element.mass_properties()
    free, fixed = element.frequencies(max(1, count)), element.frequencies(count, held=True)
    whole = points is not None or element.surface is not None
    if points is None:
        surface = np.zeros((0, 3)) if element.surface is None else element.surface.points
        points = np.vstack([element.positions, surface])
    size = np.ptp(points, axis=0)
    return Summary(
        name=element.name,
        size=size,
        nodes=dict(zip(element.nodes, element.positions, strict=True)),
        coordinates=element.size,
        modes=element.n_modes,
        grounded=element.grounded,
        properties=known,
        fixed=fixed,
        free=free[:count],
        surprises=tuple(_surprises(known, size, free, whole=whole)),
    )


def echo(element: SuperElement | TravellingElement, name: str, points: FloatArray | None = None) -> None:
    """Log mass, size and first frequency in SI, and a warning for each figure that no part of that kind has."""
    first = element if isinstance(element, SuperElement) else element.elements[0]
    try:
        summary = summarize(first, 1, points)
    except PrsError as error:
        logger.warning("%s: no frequencies: %s", name, error)
        return
    mass = "held to the ground" if summary.properties is None else f"{summary.properties.mass:.4g} kg"
    size = " x ".join(f"{length:.4g}" for length in summary.size)
    tone = (
        f", first {'held' if first.grounded else 'free'} frequency {summary.free[0]:.4g} Hz"
        if summary.free.size
        else ""
    )
    logger.info("%s: %s, nodes in %s m%s", name, mass, size, tone)
    for surprise in summary.surprises:
        logger.warning("%s: %s", name, surprise)


def _surprises(known: MassProperties | None, size: FloatArray, free: FloatArray, *, whole: bool) -> list[str]:
    """whole: the whole part is within `size`, not only its interface nodes."""
    said, longest = [], float(size.max(initial=0.0))
    advice = "check 'units'"
    if known is not None and whole and np.all(size > 1e-3 * longest) and known.mass > HEAVIEST * np.prod(size):
        said.append(f"{known.mass:.4g} kg within {np.prod(size):.3g} m^3 is denser than any metal; {advice}")
    reach = longest if known is not None else float(size.min(initial=np.inf)) if whole else 0.0
    if free.size and 2.0 * reach * free[0] > FASTEST:
        said.append(
            f"its first free frequency, {free[0]:.4g} Hz, is too high for a part {longest:.4g} m long; {advice}"
        )
    if longest > LONGEST or 0.0 < longest < 1e-3:
        said.append(f"its nodes are {longest:.4g} m apart; {advice}")
    return said
