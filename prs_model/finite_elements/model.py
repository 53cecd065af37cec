"""The finite-element model of one part: sparse matrices on nodes, and the sets that name some of them."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from ..arrays import FloatArray, IntArray
from ..description.interface import Selection
from ..errors import PartFileError, PrsError
from ..linear_algebra import lowest_eigenvalues
from .mass import MassProperties, mass_properties
from .rigid_motion import transfer
from .selection import select, unknown_set


@dataclass(frozen=True, eq=False)
class FiniteElementModel:
    """Full matrices of one part in its body frame, SI.

    stiffness, mass: (n, n) sparse. coordinates: (n_nodes, 3) m. dofs: (n, 2), the node index and component (0..5 for
    ux..rz) of every row. node_ids: (n_nodes,) labels (numbers or names) of the part file, where they are known.
    node_sets: node indices by name; set_weights: areas [m^2] of a set's nodes; areas: (n_nodes,) of all nodes, on the
    whole outer surface.
    triangles: (t, 3) node indices of the outer surface. mid_sides: (t, 3) of the nodes between its first two corners,
    its last two, and its last and first; (t, 0) of linear elements; None where they are unknown.
    """

    stiffness: csr_array
    mass: csr_array
    coordinates: FloatArray
    dofs: IntArray
    node_ids: NDArray[Any] | None = None
    node_sets: Mapping[str, IntArray] = field(default_factory=dict)
    set_weights: Mapping[str, FloatArray] = field(default_factory=dict)
    areas: FloatArray | None = None
    triangles: IntArray | None = None
    mid_sides: IntArray | None = None
    provenance: Mapping[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        n, nodes = self.stiffness.shape[0], len(self.coordinates)
        shapes: dict[str, tuple[tuple[int, ...], tuple[int, ...]]] = {
            "stiffness": (self.stiffness.shape, (n, n)),
            "mass": (self.mass.shape, (n, n)),
            "coordinates": (self.coordinates.shape, (nodes, 3)),
            "dofs": (self.dofs.shape, (n, 2)),
        }
        for name in ("node_ids", "areas"):
            if (given := getattr(self, name)) is not None:
                shapes[name] = (given.shape, (nodes,))
        if self.mid_sides is not None:
            t = 0 if self.triangles is None else len(self.triangles)
            shapes["mid_sides"] = (self.mid_sides.shape, (t, 3 if self.mid_sides.size else 0))
        for name, (found, expected) in shapes.items():
            if found != expected:
                raise PrsError(f"{self.name}: {name} has shape {found}, expected {expected}")
        for array in (self.coordinates, self.dofs):
            array.setflags(write=False)

    @property
    def size(self) -> int:
        """Number of degrees of freedom."""
        return int(self.stiffness.shape[0])

    @property
    def name(self) -> str:
        """The part's name in messages."""
        return self.provenance.get("name", "finite-element model")

    @property
    def source(self) -> str:
        """The file the part was read from, or its name."""
        return self.provenance.get("source", self.name)

    @property
    def facets(self) -> IntArray | None:
        """(t, 3 or 6): corners and mid-side nodes of the outer surface; None where they are unknown."""
        if self.triangles is None or self.mid_sides is None:
            return None
        return np.hstack([self.triangles, self.mid_sides])

    @cached_property
    def rows(self) -> IntArray:
        """(n_nodes, 6): the row of each node and component, -1 where there is none."""
        rows = np.full((len(self.coordinates), 6), -1)
        rows[self.dofs[:, 0], self.dofs[:, 1]] = np.arange(self.size)
        return rows

    def rows_of(self, nodes: IntArray) -> IntArray:
        """All rows of these nodes, in order."""
        found = self.rows[nodes].ravel()
        return found[found >= 0]

    def rigid_body_modes(self, rows: IntArray | None = None, about: FloatArray | None = None) -> FloatArray:
        """(n, 6) or (len(rows), 6): the DOFs under unit rigid motions of a point [m] (default: the body origin)."""
        dofs = self.dofs if rows is None else self.dofs[rows]
        nodes, place = np.unique(dofs[:, 0], return_inverse=True)
        arms = self.coordinates[nodes] - (np.zeros(3) if about is None else about)
        return np.asarray(transfer(arms)[place, dofs[:, 1]])

    def mass_properties(self) -> MassProperties:
        """Mass [kg], centre [m] and inertia about it [kg m^2]; without the nodes that are clamped."""
        phi = self.rigid_body_modes()
        return mass_properties(phi.T @ (self.mass @ phi))

    def frequencies(self, count: int) -> FloatArray:
        """The lowest natural frequencies [Hz] of the full matrices, those of rigid motion (about zero) among them.

        Raises PrsError when the matrices are singular beyond rigid motion.
        """
        values = lowest_eigenvalues(self.stiffness, self.mass, count)
        return np.asarray(np.sign(values) * np.sqrt(np.abs(values)) / (2.0 * np.pi))

    def select(self, selection: Selection) -> tuple[IntArray, FloatArray]:
        """Indices and weights of the nodes a selection names. Raises PartFileError when it names none."""
        return select(self, selection)

    def clamp(self, sets: Iterable[str]) -> FiniteElementModel:
        """The model with every DOF of these node sets held. Raises PartFileError for a set it does not have."""
        held = np.zeros(len(self.coordinates), dtype=bool)
        for name in sets:
            if name not in self.node_sets:
                raise PartFileError(self.source, unknown_set(self, name, "clamped"))
            held[self.node_sets[name]] = True
        kept = np.flatnonzero(~held[self.dofs[:, 0]])
        return replace(
            self,
            stiffness=csr_array(self.stiffness[kept][:, kept]),
            mass=csr_array(self.mass[kept][:, kept]),
            dofs=self.dofs[kept].copy(),
        )
