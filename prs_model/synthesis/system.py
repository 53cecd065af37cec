"""The synthesised system: M, C, K with a label on every row, and the way back to each body."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray, IntArray
from ..description.schema import Damping
from ..kinematics import Configuration
from ..reduction import SuperElement
from .ends import Ends

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from ..modes import Modes
    from ..response import ComplexModes, DampingLike, FrequencyResponse, Response, StateSpace
    from ..response.quantity import ComplexArray


class Coordinate(NamedTuple):
    """What one row of the system is: a node's displacement or rotation in body axes, or a modal coordinate."""

    body: str
    node: str
    dof: str


@dataclass(frozen=True, eq=False)
class SpringMotion:
    """Relative displacement D (6, k) of a spring's ends on body coordinates `rows` (k,), and its stiffness (6, 6).

    blocks, motions: D by the bodies, (6, n_b) each on their rows. In many configurations all are stacks (N, ..).
    """

    joint: str
    interface: str | None
    blocks: tuple[slice, ...]
    motions: tuple[FloatArray, ...]
    stiffness: FloatArray

    @property
    def rows(self) -> IntArray:
        """The bodies' coordinates (k,), ascending."""
        return np.concatenate([np.arange(block.start, block.stop) for block in self.blocks])

    @cached_property
    def displacement(self) -> FloatArray:
        """D (6, k), or (N, 6, k)."""
        return np.concatenate(self.motions, axis=-1)


@dataclass(frozen=True, eq=False, repr=False)
class System:
    """M u'' + C u' + K u = f in one configuration (eq. 16, 17), SI units, displacements in body axes.

    `expansion` (N, n) gives all N body coordinates from the n independent ones; it is the identity where no joint
    is rigid. `blocks` are the rows of each body among the N. `output` (6, n) reads the end-reference point, a node of
    `output_body`, in the axes of the output frame; `output_placement` is where it stands in the world, `placements`
    where the bodies do. `stems` names the kind of each body and joint, `limbs` the limb of those that are in one.
    """

    mass: FloatArray
    stiffness: FloatArray
    index: tuple[Coordinate, ...]
    expansion: FloatArray
    blocks: Mapping[str, slice]
    elements: Mapping[str, SuperElement]
    springs: tuple[SpringMotion, ...]
    output: FloatArray
    output_body: str
    output_placement: pin.SE3
    placements: Mapping[str, pin.SE3]
    configuration: Configuration
    stems: Mapping[str, str]
    limbs: Mapping[str, str]
    damping_model: Damping

    def __post_init__(self) -> None:
        for matrix in (self.mass, self.stiffness, self.expansion, self.output):
            matrix.setflags(write=False)

    def __repr__(self) -> str:
        return f"System({self.size} coordinates, {len(self.elements)} bodies, {len(self.springs)} springs)"

    @property
    def size(self) -> int:
        """Number of independent coordinates."""
        return len(self.index)

    @cached_property
    def damping(self) -> FloatArray:
        """C (n, n) [N s/m and so on]: alpha M + beta K, or M Phi diag(2 xi omega) Phi^T M over all modes; and tau_j K_j
        of joints with a time constant tau_j. Loss factors are in `loss_stiffness`."""
        from ..response.damping import viscous_matrix

        return viscous_matrix(self, self.damping_model)

    @cached_property
    def loss_stiffness(self) -> FloatArray:
        """H (n, n) [N/m and so on]: sum eta_j K_j over joints with a loss factor eta_j; the stiffness is K + j H."""
        from ..response.damping import loss_joints

        return loss_joints(self, self.damping_model)

    @property
    def ends(self) -> Ends:
        """Reads the motion of any node."""
        return Ends(self.elements, self.blocks, self.placements)

    def modes(self, count: int = 8) -> Modes:
        """The lowest `count` natural modes (fewer where the mass matrix has a lower rank)."""
        from ..modes import modes_of

        return modes_of(self, count)

    def complex_modes(self, count: int = 8, damping: DampingLike = None) -> ComplexModes:
        """The `count` slowest motions psi e^(s t) under damping: frequencies, damping ratios, complex shapes.

        damping: as in `frf`. Directions without mass take no part; what does not oscillate is left out.
        """
        from ..modes.modes import check_count
        from ..response.complex_modes import complex_modes
        from ..response.damping import damping_of

        check_count(count)
        return complex_modes(self, count, damping_of(self, damping))

    def frf(
        self,
        frequencies_hz: ArrayLike,
        damping: DampingLike = None,
        to: str | None = None,
        at: str | None = None,
        quantity: Response = "receptance",
    ) -> ComplexArray:
        """(f, 6, 6) as Modes.frf, by a solve for each frequency, exact for every damping model."""
        return self.frequency_response(frequencies_hz, damping, to, at, quantity).values

    def frequency_response(
        self,
        frequencies_hz: ArrayLike,
        damping: DampingLike = None,
        to: str | None = None,
        at: str | None = None,
        quantity: Response = "receptance",
    ) -> FrequencyResponse:
        """`frf` with its labels and units, to be saved or drawn."""
        from ..response.frequency_response import of_system

        return of_system(self, frequencies_hz, damping, to, at, quantity)

    def static_compliance(self, to: str | None = None, at: str | None = None) -> FloatArray:
        """(6, 6) motion of node `to` along and about u, v, w for unit forces and moments at node `at`, by a solve.

        Nodes are ``body.node``; default: the end-reference point. [m/N, rad/N; 1/N, rad/(N m)]
        Raises PrsError when the machine can move without straining anything.
        """
        from ..response.points import point
        from ..response.static import static_compliance

        return static_compliance(self, point(self, to), point(self, at))

    def static_energy(self, at: str | None = None) -> dict[str, FloatArray]:
        """Share (6,) of each body and joint in the strain energy under a unit force or moment at node `at`.

        A force along u, v, w or a moment about them, one after the other; the shares of each sum to one. As the energy
        is half the compliance there, this is where the compliance comes from: a joint twice as stiff takes off half
        its share, about. Raises PrsError when the machine can move without straining anything.
        """
        from ..modes.energy import strain_shares
        from ..response.points import point
        from ..response.static import static_motion

        return strain_shares(self, static_motion(self, point(self, at)))

    def state_space(
        self,
        modes: int = 20,
        damping: DampingLike = None,
        to: str | None = None,
        at: str | None = None,
        quantity: Response = "receptance",
        static_correction: bool | None = None,
        residual_vectors: bool = False,
    ) -> StateSpace:
        """A, B, C, D on the lowest so many modes; see Modes.state_space."""
        return self.modes(modes).state_space(damping, to, at, quantity, static_correction, residual_vectors)
