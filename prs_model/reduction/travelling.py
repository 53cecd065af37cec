"""A part whose reduced matrices follow one joint coordinate smoothly, such as a rail under a travelling carriage."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicSpline

from ..arrays import FloatArray, IntArray
from ..errors import PrsError
from ..finite_elements.rigid_motion import transfer
from .flexibility import congruent, flexibility_form, force_coordinates, force_stiffness, positive_mean
from .gate import GateReport
from .super_element import SuperElement, read_only
from .surface import Surface


@dataclass(frozen=True, eq=False)
class TravellingElement:
    """Super-elements of one part at increasing values of a joint, all of the same layout.

    stations: (s,) joint values [m or rad]; elements: one per station. In between, everything follows the cubic spline
    weights w_k(q) of the stations. Motions are interpolated as seen from the body origin and carried to the node
    afterwards, so rigid motions are exact: ``motion = X(r(q)) sum_k w_k X(-r_k) motion_k``. Matrices are interpolated
    in flexibility form (see `flexibility_form`), in which they are smooth along a slender part too.

    products: (2, s, s, n, n), V_i^T K V_j and V_i^T M V_j of the stations' bases V_k. With them, all but the contact's
    flexibility is that of the interpolated shapes sum_k w_k V_k, and so never negative; without, it is interpolated
    entry by entry.
    """

    joint: str
    stations: FloatArray
    elements: tuple[SuperElement, ...]
    products: FloatArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "stations", read_only(self.stations))
        s, first = len(self.elements), self.elements[0]
        if self.stations.shape != (s,) or s < 2 or np.any(np.diff(self.stations) <= 0.0):
            raise PrsError("travelling element: needs increasing stations, at least two, and one element for each")
        if self.products is not None:
            object.__setattr__(self, "products", read_only(self.products))
            if self.products.shape != (2, s, s, first.size, first.size):
                raise PrsError(f"travelling element: products has shape {self.products.shape}")
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
        weights = self.weights(value)
        stiffness, mass, change = self._matrices(weights)
        positions = np.tensordot(weights, self._positions, 1)
        return replace(
            self.elements[0],
            stiffness=congruent(stiffness, change),
            mass=congruent(mass, change),
            positions=positions,
            motions=transfer(positions) @ np.tensordot(weights, self._motions_of_origin, 1),
            surface=self._surface(weights, change) if surface else None,
            provenance={**self.elements[0].provenance, "modes": "interpolated"},
        )

    def weights(self, value: float) -> FloatArray:
        """(s,) weights of the stations at a joint value; they sum to one. Raises PrsError outside the stations."""
        low, high = self.stations[0], self.stations[-1]
        slack = 1e-9 * (high - low)
        if not low - slack <= value <= high + slack:
            raise PrsError(
                f"{self.name}: its contact travels with joint {self.joint} from {low:g} to {high:g}, asked for "
                f"{value:g}; add stations to 'travel' or stay inside"
            )
        return np.asarray(self._cardinal(value))

    def check(self) -> tuple[GateReport, ...]:
        """Pass the physics gate at every station and midway between them. Raises PhysicsError."""
        middles = (self.stations[:-1] + self.stations[1:]) / 2.0
        between = [
            replace(self.at(value, surface=False), provenance={"name": f"{self.name} at {self.joint} = {value:g}"})
            for value in middles
        ]
        return tuple(each.check() for each in (*self.elements, *between))

    @cached_property
    def _cardinal(self) -> CubicSpline:
        return CubicSpline(self.stations, np.eye(len(self.stations)))

    @cached_property
    def _positions(self) -> FloatArray:
        return np.array([each.positions for each in self.elements])

    @cached_property
    def _motions_of_origin(self) -> FloatArray:
        return np.array([transfer(-each.positions) @ each.motions for each in self.elements])

    @cached_property
    def _contact(self) -> IntArray:
        """Coordinates of the nodes that move along the body, where they are the same at all stations."""
        moving = np.flatnonzero(np.ptp(self._positions, axis=0).max(axis=1) > 1e-9)
        used = np.array([np.any(each.motions[moving] != 0.0, axis=(0, 1)) for each in self.elements])
        contact = np.flatnonzero(np.all(used, axis=0))
        held = self.elements[0].stiffness[np.ix_(contact, contact)]
        alone = len(contact) and np.linalg.eigvalsh(held)[0] < 1e-10 * np.abs(self.elements[0].stiffness).max()
        return np.zeros(0, dtype=np.int64) if alone else contact

    @cached_property
    def _forms(self) -> FloatArray:
        return np.array([flexibility_form(each.stiffness, self._contact) for each in self.elements])

    @cached_property
    def _changes(self) -> FloatArray:
        return np.array([force_coordinates(form, self._contact) for form in self._forms])

    @cached_property
    def _force_products(self) -> FloatArray:
        """Products in force coordinates, (2, s, s, n, n)."""
        changes = self._changes
        return np.asarray(changes.swapaxes(1, 2)[:, None] @ np.asarray(self.products) @ changes[None, :])

    @cached_property
    def _force_matrices(self) -> FloatArray:
        """Stiffness and mass of the stations in force coordinates, (2, s, n, n)."""
        pairs = zip(self.elements, self._changes, strict=True)
        stacked = [[congruent(matrix, change) for matrix in (each.stiffness, each.mass)] for each, change in pairs]
        return np.array(stacked).swapaxes(0, 1)

    @cached_property
    def _flexibility(self) -> Callable[[FloatArray], FloatArray]:
        return positive_mean(self._forms[:, self._contact[:, None], self._contact])

    def _matrices(self, weights: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Stiffness and mass in force coordinates, and what leads from physical coordinates to these."""
        if self.products is None:
            stiffness, mass = np.einsum("i,xiab->xab", weights, self._force_matrices)
        else:
            stiffness, mass = np.einsum("i,j,xijab->xab", weights, weights, self._force_products, optimize=True)
        form = np.tensordot(weights, self._forms, 1)
        form[np.ix_(self._contact, self._contact)] = self._flexibility(weights)
        change = np.asarray(np.linalg.inv(force_coordinates(form, self._contact)), dtype=float)
        return force_stiffness(form, stiffness, self._contact), mass, change

    @cached_property
    def _recovery(self) -> FloatArray | None:
        recoveries = [
            each.surface.recovery @ change
            for each, change in zip(self.elements, self._changes, strict=True)
            if each.surface is not None
        ]
        return np.array(recoveries) if len(recoveries) == len(self.elements) else None

    def _surface(self, weights: FloatArray, change: FloatArray) -> Surface | None:
        first = self.elements[0].surface
        if first is None or self._recovery is None:
            return None
        recovery = np.tensordot(weights, self._recovery, 1) @ change
        return replace(first, recovery=recovery.astype(np.float32))
