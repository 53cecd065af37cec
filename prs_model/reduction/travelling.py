"""A part whose reduced matrices follow one joint coordinate smoothly, such as a rail under a travelling carriage."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import CubicSpline

from ..errors import PrsError
from ..finite_elements.rigid_motion import transfer
from .gate import GateReport
from .super_element import SuperElement
from .surface import Surface

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class TravellingElement:
    """Super-elements of one part at increasing values of a joint, all of the same layout.

    stations: (s,) joint values [m or rad]; elements: one per station. In between, stiffness, mass and the nodes'
    motions are cubic splines. Motions are splined as seen from the body origin and carried to the node afterwards,
    so rigid motions are exact at every value: ``motion = X(r(q)) spline(X(-r_k) motion_k)``.
    """

    joint: str
    stations: FloatArray
    elements: tuple[SuperElement, ...]

    def __post_init__(self) -> None:
        stations = np.array(self.stations, dtype=float)
        stations.setflags(write=False)
        object.__setattr__(self, "stations", stations)
        if len(stations) != len(self.elements) or len(stations) < 2 or np.any(np.diff(stations) <= 0.0):
            raise PrsError("travelling element: needs increasing stations, at least two, and one element for each")
        first = self.elements[0]
        if any(each.nodes != first.nodes or each.labels != first.labels for each in self.elements):
            raise PrsError("travelling element: nodes and coordinates differ between its stations")

    @property
    def nodes(self) -> tuple[str, ...]:
        return self.elements[0].nodes

    @property
    def labels(self) -> tuple[str, ...]:
        return self.elements[0].labels

    @property
    def size(self) -> int:
        return self.elements[0].size

    @property
    def n_modes(self) -> int:
        return self.elements[0].n_modes

    @property
    def grounded(self) -> bool:
        return self.elements[0].grounded

    @property
    def name(self) -> str:
        return self.elements[0].name

    def at(self, value: float, *, surface: bool = True) -> SuperElement:
        """The super-element at a joint value [m or rad]; `surface=False` leaves the picture data out.

        Raises PrsError when the value is outside the stations.
        """
        low, high = self.stations[0], self.stations[-1]
        slack = 1e-9 * (high - low)
        if not low - slack <= value <= high + slack:
            raise PrsError(
                f"{self.name}: its contact travels with joint {self.joint} from {low:g} to {high:g}, asked for "
                f"{value:g}; add stations to 'travel' or stay inside"
            )
        stiffness, mass, positions, local = self._split(self._spline(value))
        return replace(
            self.elements[0],
            stiffness=stiffness,
            mass=mass,
            positions=positions,
            motions=transfer(positions) @ local,
            surface=self._surface_at(value) if surface else None,
        )

    def check(self) -> tuple[GateReport, ...]:
        """Pass the physics gate at every station and midway between them. Raises PhysicsError."""
        middles = (self.stations[:-1] + self.stations[1:]) / 2.0
        between = [replace(self.at(value, surface=False), provenance=self._named(value)) for value in middles]
        return tuple(each.check() for each in (*self.elements, *between))

    def _named(self, value: float) -> dict[str, str]:
        return {"name": f"{self.name} at {self.joint} = {value:g}"}

    @cached_property
    def _spline(self) -> CubicSpline:
        flat = [
            np.concatenate(
                [part.ravel() for part in (each.stiffness, each.mass, each.positions, _seen_from_origin(each))]
            )
            for each in self.elements
        ]
        return CubicSpline(self.stations, np.array(flat), axis=0)

    def _split(self, flat: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
        n, k = self.size, len(self.nodes)
        ends = np.cumsum([n * n, n * n, 3 * k])
        stiffness, mass, positions, motions = np.split(flat, ends)
        return stiffness.reshape(n, n), mass.reshape(n, n), positions.reshape(k, 3), motions.reshape(k, 6, n)

    @cached_property
    def _recovery(self) -> CubicSpline | None:
        surfaces = [each.surface for each in self.elements]
        if any(surface is None for surface in surfaces):
            return None
        return CubicSpline(self.stations, np.array([s.recovery for s in surfaces if s is not None]), axis=0)

    def _surface_at(self, value: float) -> Surface | None:
        first = self.elements[0].surface
        if first is None or self._recovery is None:
            return None
        return Surface(first.points, first.triangles, self._recovery(value).astype(np.float32))


def _seen_from_origin(element: SuperElement) -> FloatArray:
    return np.asarray(transfer(-element.positions) @ element.motions)
