"""One part in many configurations: the matrices of its super-element, stacked."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from .super_element import SuperElement


@dataclass(frozen=True, eq=False)
class Elements:
    """What of a SuperElement may follow a travelling contact, for N configurations; N is 1 where nothing does.

    mass, stiffness (N, n, n); nodes: k names; positions (N, k, 3) m; motions_of_origin (N, k, 6, n), the nodes' motions
    carried to the body origin. name: the part's in messages.
    """

    mass: FloatArray
    stiffness: FloatArray
    nodes: tuple[str, ...]
    positions: FloatArray
    motions_of_origin: FloatArray
    name: str

    @classmethod
    def of(cls, element: SuperElement) -> Elements:
        """A part that is the same in all configurations."""
        matrices = (element.mass[None], element.stiffness[None])
        return cls(*matrices, element.nodes, element.positions[None], element.motions_of_origin[None], element.name)

    @property
    def size(self) -> int:
        """Number of coordinates n."""
        return int(np.shape(self.mass)[-1])
