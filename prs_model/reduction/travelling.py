"""A part whose reduced matrices follow one joint coordinate smoothly, such as a rail under a travelling carriage.

Between stations a plain spline of K and M does not do: on slender rails with stations 50 to 100 mm apart it yields
negative mass and stiffness, because K grows like 1/a^3 as the arm a from the contact to the next node gets short. So:

- K is interpolated in flexibility form, whose entries are smooth; its part with the contact free hardly depends on
  where the contact is and is interpolated entry by entry. (Shapes interpolated as those of the mass are, weighted with
  w_i w_j, are not in equilibrium in between: their spurious energy would stiffen the part by up to a tenth.)
- the contact's flexibility is interpolated by a mean of logarithms, which stays positive where weights are negative,
- M is that of the interpolated shapes sum_k w_k V_k, and so never negative.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.interpolate import BSpline, make_interp_spline

from ..arrays import FloatArray, IntArray
from ..errors import PrsError
from ..finite_elements.rigid_motion import transfer
from .elements import Elements
from .flexibility import congruent, flexibility_form, force_coordinates, force_stiffness, positive_mean
from .gate import Check, GateReport, passed
from .super_element import SuperElement, read_only
from .surface import Surface


@dataclass(frozen=True, eq=False)
class TravellingElement:
    """Super-elements of one part at increasing values of a joint, all of the same layout.

    stations: (s,) joint values [m or rad]; elements: one per station. In between, everything follows weights w_k(q):
    the cardinal splines of degree five on the stations (s - 1 where these are fewer), whose four continuous derivatives
    keep frequencies smooth in the pose. Motions are interpolated as seen from the body origin and carried to the
    node afterwards, so rigid motions are exact: ``motion = X(r(q)) sum_k w_k X(-r_k) motion_k``. Matrices are
    interpolated in flexibility form (see `flexibility_form`), in which they are smooth along a slender part too.

    products: (s, s, n, n), V_i^T M V_j of the stations' bases V_k, so that the mass is that of the interpolated shapes;
    without them it is interpolated entry by entry. contact: coordinates whose stiffness is interpolated through its
    inverse, which must exist; by default those that the travelling nodes follow, where it does.
    """

    joint: str
    stations: FloatArray
    elements: tuple[SuperElement, ...]
    products: FloatArray | None = None
    contact: tuple[int, ...] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "stations", read_only(self.stations))
        s, first = len(self.elements), self.elements[0]
        if self.stations.shape != (s,) or s < 2 or np.any(np.diff(self.stations) <= 0.0):
            raise PrsError("travelling element: needs increasing stations, at least two, and one element for each")
        if self.products is not None:
            object.__setattr__(self, "products", read_only(self.products))
            if self.products.shape != (shape := (s, s, first.size, first.size)):
                raise PrsError(f"travelling element: products has shape {self.products.shape}, expected {shape}")
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

    def at(self, value: float) -> SuperElement:
        """The super-element at a joint value [m or rad]. Raises PrsError when it is outside the stations."""
        weights = self.weights(value)
        stiffness, mass, change = self._matrices(weights)
        positions = np.tensordot(weights, self._positions, 1)
        return replace(
            self.elements[0],
            stiffness=congruent(stiffness, change),
            mass=congruent(mass, change),
            positions=positions,
            motions=transfer(positions) @ np.tensordot(weights, self._motions_of_origin, 1),
            surface=self._surface(weights, change),
            provenance={**self.elements[0].provenance, "modes": "interpolated"},
        )

    def at_many(self, values: ArrayLike) -> Elements:
        """The same at joint values (N,), all at once. Raises PrsError when one is outside the stations."""
        weights = self.weights(values)
        stiffness, mass, change = self._matrices(weights)
        return Elements(
            mass=congruent(mass, change),
            stiffness=congruent(stiffness, change),
            nodes=self.nodes,
            positions=np.tensordot(weights, self._positions, 1),
            motions_of_origin=np.tensordot(weights, self._motions_of_origin, 1),
            name=self.name,
        )

    def weights(self, values: ArrayLike) -> FloatArray:
        """Weights (s,) or (N, s) of the stations at one or N joint values; their sum is one.

        Raises PrsError outside the stations.
        """
        low, high = self.stations[0], self.stations[-1]
        asked, slack = np.asarray(values, dtype=float), 1e-9 * (high - low)
        outside = ~((low - slack <= asked) & (asked <= high + slack))
        if outside.any():
            raise PrsError(
                f"{self.name}: its contact travels with joint {self.joint} from {low:g} to {high:g}, asked for "
                f"{asked[outside][0]:g}; add stations to 'travel' or stay inside"
            )
        return np.asarray(self._cardinal(asked))

    def check(self) -> tuple[GateReport, ...]:
        """Pass the physics gate at every station and midway between them, with one mass. Raises PhysicsError."""
        middles = (self.stations[:-1] + self.stations[1:]) / 2.0
        between = [self._named(self.at(value), f"{self.name} at {self.joint} = {value:g}") for value in middles]
        whole = passed(self.name, self._checks_of_mass(between))
        return (whole, *(each.check() for each in (*self.elements, *between)))

    @staticmethod
    def _named(element: SuperElement, name: str) -> SuperElement:
        return replace(element, provenance={**element.provenance, "name": name})

    def _checks_of_mass(self, between: Sequence[SuperElement]) -> Iterator[Check]:
        """What a damaged mass cannot hide: it is that of every station there, and the same rigid body in between."""
        cause = "the file is damaged, or its stations are not of one part: make it again from its source"
        stations = np.array([each.mass for each in self.elements])
        if self.products is not None:
            apart = np.diagonal(self.products).transpose(2, 0, 1) - stations
            yield Check("mass between stations meets theirs", _largest(apart, stations), 1e-9, cause)
        phi = self.elements[0].rigid_body_modes()
        rigid = [phi.T @ each.mass @ phi for each in (*self.elements, *between)]
        spread = np.array(rigid) - rigid[0]
        if not self.grounded:
            yield Check("mass is the same everywhere", _largest(spread, rigid[0]), 1e-6, cause)

    @cached_property
    def _cardinal(self) -> BSpline:
        s = len(self.stations)
        return make_interp_spline(self.stations, np.eye(s), k=min(5, s - 1))

    @cached_property
    def _positions(self) -> FloatArray:
        return np.array([each.positions for each in self.elements])

    @cached_property
    def _motions_of_origin(self) -> FloatArray:
        return np.array([each.motions_of_origin for each in self.elements])

    @cached_property
    def _contact(self) -> IntArray:
        """Coordinates of the nodes that move along the body, where they are the same at all stations."""
        if self.contact is not None:
            return np.array(self.contact, dtype=np.int64)
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
        """Products in force coordinates, (s, s, n, n)."""
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
        contact = f"{self.name}, whose contact travels with joint {self.joint}"
        return positive_mean(self._forms[:, self._contact[:, None], self._contact], contact)

    def _matrices(self, weights: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Stiffness and mass in force coordinates, and what leads from physical coordinates to these; or stacks."""
        stiffness, mass = (np.tensordot(weights, matrices, 1) for matrices in self._force_matrices)
        if self.products is not None:
            pairs = weights[..., :, None] * weights[..., None, :]
            mass = np.tensordot(pairs, self._force_products, 2)
        form = np.tensordot(weights, self._forms, 1)
        form[..., self._contact[:, None], self._contact] = self._flexibility(weights)
        change = np.asarray(np.linalg.inv(force_coordinates(form, self._contact)), dtype=float)
        return force_stiffness(form, stiffness, self._contact), mass, change

    def _surface(self, weights: FloatArray, change: FloatArray) -> Surface | None:
        surfaces = [each.surface for each in self.elements if each.surface is not None]
        if len(surfaces) < len(self.elements):
            return None

        def recovery() -> NDArray[np.float32]:
            parts = zip(weights, surfaces, self._changes, strict=True)
            return np.asarray(sum(w * (each.recovery @ (to @ change)) for w, each, to in parts), dtype=np.float32)

        return replace(surfaces[0], source=recovery)


def _largest(part: FloatArray, whole: FloatArray) -> float:
    return float(np.abs(part).max() / (np.abs(whole).max() or 1.0))
