"""Natural modes of a system and where their energy sits."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import BoolArray, FloatArray
from ..errors import PrsError
from ..linear_algebra import lowest_modes, slowest_rate
from ..synthesis.system import System
from . import energy
from .character import Character, characters
from .clusters import principal_shapes

if TYPE_CHECKING:
    import xarray
    from numpy.typing import ArrayLike

    from ..response import DampingLike, FrequencyResponse, Response, StateSpace, WeakMode
    from ..response.quantity import ComplexArray

_RIGID = 1e-8
_BEYOND = 5  # modes beyond those asked for, so that none is parted from others of its frequency


@dataclass(frozen=True, eq=False, repr=False)
class Modes:
    """Natural frequencies [Hz] ascending and mass-normalised shapes (n, k) on the system's coordinates.

    Of modes of equal frequency the first has all their motion of the end-reference point along u, the next what is
    left along v, and so on.
    """

    system: System
    eigenvalues: FloatArray
    shapes: FloatArray

    def __repr__(self) -> str:
        return f"Modes({', '.join(f'{f:.4g}' for f in self.frequencies)} Hz)"

    @property
    def frequencies(self) -> FloatArray:
        """(k,) [Hz]; zero for rigid-body modes."""
        return np.asarray(np.sqrt(np.where(self.is_rigid, 0.0, self.eigenvalues)) / (2.0 * np.pi))

    @cached_property
    def is_rigid(self) -> BoolArray:
        """(k,) whether a mode strains nothing: its eigenvalue is round-off beside those of the held coordinates."""
        return np.asarray(self.eigenvalues <= _RIGID * slowest_rate(self.system.mass, self.system.stiffness))

    @property
    def output_shapes(self) -> FloatArray:
        """(6, k): motion of the end-reference point in the output frame, translations first."""
        return self.system.output @ self.shapes

    def body_shapes(self, body: str) -> FloatArray:
        """(m, k): the shapes on one body's own coordinates, in its body frame."""
        return self.system.expansion[self.system.blocks[body]] @ self.shapes

    def kinetic_energy(self) -> dict[str, FloatArray]:
        """Share (k,) of each mode's kinetic energy in each body; the shares of a mode sum to one (eq. 22)."""
        return energy.kinetic_energy(self)

    def strain_energy(self) -> dict[str, FloatArray]:
        """Share (k,) of each mode's strain energy in each body and each joint; the shares of a mode sum to one.

        Rigid-body modes have none: their shares are zero. A joint of the same name as a body is called ``joint ..``.
        """
        return energy.strain_energy(self)

    def kinetic_energy_by_limb(self) -> dict[str, FloatArray]:
        """Share (k,) of each mode's kinetic energy in each limb, and in each body that is in none."""
        return energy.by_limb(energy.kinetic_energy(self), self.system.limbs)

    def strain_energy_by_limb(self) -> dict[str, FloatArray]:
        """Share (k,) of each mode's strain energy in each limb, its joints included, and in what is in none."""
        return energy.by_limb(energy.strain_energy(self), self.system.limbs)

    def joint_strain_by_direction(self) -> dict[str, FloatArray]:
        """Share (6, k) of each mode's strain energy in each joint, along and about x, y, z of the joint's frame.

        A joint's six sum to its share; where its stiffness couples directions, one may be negative.
        """
        return energy.joint_strain_by_direction(self)

    def frf(
        self,
        frequencies_hz: ArrayLike,
        damping: DampingLike = None,
        to: str | None = None,
        at: str | None = None,
        quantity: Response = "receptance",
        static_correction: bool = True,
    ) -> ComplexArray:
        """(f, 6, 6): motion along and about u, v, w at node `to` for unit forces and moments at node `at`, eq. (18-20).

        damping: a ratio, one for each mode, or entries of machine.yaml's `damping` in SI, such as
        ``{"joints": {"P": {"loss_factor": 0.03}}}``; None is the machine's own. Nodes are ``body.node``, read in the
        axes of the output frame; default: the end-reference point.
        quantity: displacement (receptance), velocity (mobility) or acceleration (accelerance) per force.
        static_correction: add what the modes left out do at rest. With all modes the result is that of System.frf.
        Raises PrsError for frequencies not above zero, unknown nodes, or wrong damping.
        """
        return self.frequency_response(frequencies_hz, damping, to, at, quantity, static_correction).values

    def frequency_response(
        self,
        frequencies_hz: ArrayLike,
        damping: DampingLike = None,
        to: str | None = None,
        at: str | None = None,
        quantity: Response = "receptance",
        static_correction: bool = True,
    ) -> FrequencyResponse:
        """`frf` with its labels and units, to be saved or drawn."""
        from ..response.frequency_response import of_modes

        return of_modes(self, frequencies_hz, damping, to, at, quantity, static_correction)

    def damping_ratios(self, damping: DampingLike = None) -> FloatArray:
        """(k,): of each mode under a damping as in `frf`; where joints damp, of the complex mode it becomes.

        nan for rigid-body modes, and for modes that damping keeps from oscillating.
        """
        from ..response.complex_modes import ratios_of
        from ..response.damping import damping_of

        return ratios_of(self, damping_of(self.system, damping))

    def static_compliance(self, to: str | None = None, at: str | None = None) -> FloatArray:
        """(6, 6) of the system, exact whatever the number of modes; see System.static_compliance."""
        return self.system.static_compliance(to, at)

    def modal_flexibility(self, at: str | None = None) -> FloatArray:
        """(k, 6) [m/N, rad/(N m)]: what each mode gives to the compliance of node `at`, eq. (20)."""
        from ..response.flexibility import modal_flexibility

        return modal_flexibility(self, at)

    def flexibility_shares(self, at: str | None = None) -> FloatArray:
        """(k, 6): `modal_flexibility` over the static compliance by a solve, eq. (21)."""
        from ..response.flexibility import flexibility_shares

        return flexibility_shares(self, at)

    def weak_modes(self, at: str | None = None, least: float = 0.1) -> tuple[WeakMode, ...]:
        """The modes that make up the compliance of a node, direction by direction, with the reason in words.

        Those with a share of at least `least`, the largest first, and the largest whatever it is; modes of equal
        frequency are one. at: ``body.node``; default: the end-reference point.
        """
        from ..response.flexibility import weak_modes

        return weak_modes(self, at, least)

    def state_space(
        self,
        damping: DampingLike = None,
        to: str | None = None,
        at: str | None = None,
        quantity: Response = "receptance",
        static_correction: bool | None = None,
        residual_vectors: bool = False,
    ) -> StateSpace:
        """x' = A x + B f, y = C x + D f with x = (q, q') of these modes; nodes and damping as in `frf`.

        static_correction: D of a receptance is what the modes left out do at rest (default); other quantities have no
        such constant. residual_vectors: stand for the modes left out instead, as in `frf`, some thirty fast modes more
        for a node and sixty for two, for every quantity. Raises PrsError for loss factors, which have no model in time.
        """
        from ..response.state_space import state_space

        return state_space(self, damping, to, at, quantity, static_correction, residual_vectors)

    def table(self) -> xarray.Dataset:
        """Frequencies, characters, energies and flexibilities by mode, with names and units."""
        from .labelled import table

        return table(self)

    def characters(self) -> tuple[Character, ...]:
        """What moves in each mode, and along or about what."""
        return characters(self.system, self.shapes)


def modes_of(system: System, count: int) -> Modes:
    """The lowest `count` modes of a system. Raises PrsError when `count` is not a whole number above zero."""
    check_count(count)
    labels = [" ".join(filter(None, row)) for row in system.index]
    found = Modes(system, *lowest_modes(system.mass, system.stiffness, int(count) + _BEYOND, labels))
    eigenvalues = np.where(found.is_rigid, 0.0, found.eigenvalues)
    shapes = principal_shapes(system, found.frequencies, found.shapes)
    return Modes(system, eigenvalues[:count], shapes[:, :count])


def check_count(count: object) -> None:
    """Raises PrsError when so many modes cannot be asked for."""
    if not isinstance(count, int | np.integer) or isinstance(count, bool) or count < 1:
        raise PrsError(f"found {count!r} modes asked for, expected a whole number above zero")
