"""A mesh whose nodes have labels: what matrices need to become a part with places, named sets and a surface."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from prs_model.arrays import IntArray
from prs_model.part_files import NodeTable


@dataclass(frozen=True, eq=False)
class LabelledMesh:
    """table: nodes with their labels, in the file's units. All else names nodes by their place in it.

    solids: solid elements (e, 4 to 20) by their number of nodes, ordered as Abaqus does. others: (m,) nodes of all
    other elements. node_sets: by name. surfaces: by name, the faces as corners and mid-side nodes. held: (node, 0..5)
    pairs (h, 2) held by boundary conditions, None where the file does not say. tied: nodes may be joined otherwise
    than by elements, as by constraints and contact. weighing: (w,) those of others whose elements have mass.
    """

    table: NodeTable
    solids: Mapping[int, IntArray]
    others: IntArray
    node_sets: Mapping[str, IntArray]
    surfaces: Mapping[str, list[tuple[IntArray, IntArray]]] = field(default_factory=dict)
    held: IntArray | None = None
    tied: bool = False
    weighing: IntArray = field(default_factory=lambda: np.zeros(0, dtype=np.int64))

    @property
    def in_solids(self) -> IntArray:
        """(m,) nodes of solid elements, in the order of the table."""
        nodes = [each.ravel() for each in self.solids.values()]
        return np.unique(np.concatenate(nodes)) if nodes else np.zeros(0, dtype=np.int64)

    @property
    def in_elements(self) -> IntArray:
        """(m,) nodes of all elements, in the order of the table."""
        return np.union1d(self.in_solids, self.others)
