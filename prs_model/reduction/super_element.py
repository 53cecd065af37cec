"""A part as the rest of the machine sees it: small matrices on named nodes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError, short
from ..finite_elements.mass import MassProperties, mass_properties
from ..finite_elements.rigid_motion import transfer
from .surface import Surface

if TYPE_CHECKING:
    from .gate import GateReport


AXES = ("ux", "uy", "uz", "rx", "ry", "rz")


@dataclass(frozen=True, eq=False, repr=False)
class SuperElement:
    """Reduced matrices of one part in its body frame, with n coordinates and k nodes.

    stiffness, mass: (n, n), SI. nodes: k names; positions: (k, 3) m. motions: (k, 6, n), where ``motions[j] @ u`` is
    the motion (delta [m], epsilon [rad]) of node j in body axes. n_modes: number of trailing modal coordinates.
    grounded: held to the ground inside the part, so rigid motion costs energy. labels: one per coordinate.
    node_sets: names of nodes, by the name of the set. A node without rotations, say, has zero rows in its motions.
    """

    stiffness: FloatArray
    mass: FloatArray
    nodes: tuple[str, ...]
    positions: FloatArray
    motions: FloatArray
    n_modes: int = 0
    grounded: bool = False
    surface: Surface | None = None
    labels: tuple[str, ...] = ()
    node_sets: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    provenance: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("stiffness", "mass", "positions", "motions"):
            object.__setattr__(self, name, read_only(getattr(self, name)))
        n, k = len(self.stiffness), len(self.nodes)
        shapes = {"stiffness": (n, n), "mass": (n, n), "positions": (k, 3), "motions": (k, 6, n)}
        for name, shape in shapes.items():
            if getattr(self, name).shape != shape:
                raise PrsError(f"super-element: {name} has shape {getattr(self, name).shape}, expected {shape}")
        strangers = [node for nodes in self.node_sets.values() for node in nodes if node not in self.nodes]
        if strangers:
            raise PrsError(f"super-element: a node set holds {strangers[0]}, which is no node of it")
        if len(set(self.nodes)) != k:
            raise PrsError(f"super-element: node names are not unique: {', '.join(self.nodes)}")
        if not self.labels:
            object.__setattr__(self, "labels", tuple(f"coordinate {i + 1}" for i in range(n)))
        if len(self.labels) != n or not 0 <= self.n_modes <= n:
            raise PrsError(f"super-element: {len(self.labels)} labels and {self.n_modes} modes for {n} coordinates")

    def __repr__(self) -> str:
        held = ", grounded" if self.grounded else ""
        return f"SuperElement({self.name!r}, {self.size} coordinates, nodes {short(', '.join(self.nodes))}{held})"

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.stiffness)

    @property
    def name(self) -> str:
        """The part's name in messages."""
        return self.provenance.get("name", "super-element")

    def node(self, name: str) -> int:
        """Index of a node. Raises UnknownNameError listing the known ones."""
        if name not in self.nodes:
            from ..plugins import unknown

            raise unknown(f"node of {self.name}", name, list(self.nodes))
        return self.nodes.index(name)

    @cached_property
    def _rigid_body_modes(self) -> FloatArray:
        return read_only(rigid_body_modes(self.motions, self.positions))

    @cached_property
    def motions_of_origin(self) -> FloatArray:
        """(k, 6, n): the motions of the nodes carried to the body origin, as if each were rigidly tied to it."""
        return read_only(transfer(-self.positions) @ self.motions)

    def rigid_body_modes(self) -> FloatArray:
        """(n, 6): the coordinates when the part moves rigidly by unit translations and rotations of its origin.

        The smallest coordinates for which ``motions @ phi = X(position)``, so zero on the modes of a
        Craig-Bampton element. Motions that a node does not have are left out.
        """
        return self._rigid_body_modes

    def mass_properties(self) -> MassProperties:
        """Mass [kg], centre [m] and inertia about it [kg m^2] from the mass matrix in rigid motion."""
        phi = self.rigid_body_modes()
        return mass_properties(phi.T @ self.mass @ phi)

    def frequencies(self, count: int, *, held: bool = False) -> FloatArray:
        """The lowest natural frequencies [Hz]: free-free without the zeros of rigid motion, or with all nodes held.

        A grounded part is free as its file holds it. Raises PrsError for an indefinite stiffness.
        """
        from .frequencies import free_frequencies, held_frequencies

        return (held_frequencies if held else free_frequencies)(self, count)

    def check(self) -> GateReport:
        """Pass the physics gate. Raises PhysicsError naming the check that failed, its figure and the likely cause."""
        from .gate import check

        return check(self)

    def save(self, path: str | Path) -> None:
        """Store as .npz (no pickle). Raises PartFileError when the file cannot be written."""
        from .storage import save

        save(self, path)

    @classmethod
    def load(cls, path: str | Path) -> SuperElement:
        """Read what `save` wrote. Raises PartFileError when the file is missing, damaged or of another kind."""
        from .storage import load_super_element

        return load_super_element(path)


def rigid_body_modes(motions: FloatArray, positions: FloatArray) -> FloatArray:
    """Smallest phi (n, 6) with ``motions @ phi = X(positions)`` in the least-squares sense; see SuperElement."""
    rows, wanted = present_motions(motions, transfer(positions))
    return np.asarray(np.linalg.lstsq(rows, wanted, rcond=1e-10)[0])


def present_motions(motions: FloatArray, wanted: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Rows (m, n) and right sides (m, c): the motions that each node has, and what is wanted (k, 6, c) of them.

    A node with fewer than six independent motions (without rotations, or held along one axis) counts with those only.
    """
    rows, sides = [], []
    for motion, side in zip(motions, wanted, strict=True):
        if np.linalg.matrix_rank(motion, tol=1e-10 * np.max(np.abs(motion), initial=1e-300)) < 6:
            axes, size, _ = np.linalg.svd(motion, full_matrices=False)
            own = axes[:, size > 1e-10 * size[0]].T if size[0] > 0.0 else np.zeros((0, 6))
            motion, side = own @ motion, own @ side
        rows.append(motion)
        sides.append(side)
    return np.concatenate(rows), np.concatenate(sides)


def node_labels(node: str) -> tuple[str, ...]:
    """Labels of a node's six coordinates, such as ``hinge.ux``."""
    return tuple(f"{node}.{axis}" for axis in AXES)


def read_only(array: FloatArray) -> FloatArray:
    """A copy that cannot be written to."""
    array = np.array(array, dtype=float)
    array.setflags(write=False)
    return array
