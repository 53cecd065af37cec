"""A rigid body: mass, inertia, and the points where joints take hold of it."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from pydantic import Field, model_validator
from pydantic_core import PydanticCustomError

from prs_model.description.quantity import Inertia, Mass, Quantity
from prs_model.description.schema import Point, Section
from prs_model.finite_elements.mass import excess_moment
from prs_model.finite_elements.rigid_motion import transfer
from prs_model.plugins import PartRequest, Reducer
from prs_model.reduction import SuperElement
from prs_model.reduction.super_element import node_labels

ZERO = Quantity(0.0)


class InertiaTensor(Section):
    """Inertia about the mass centre, in body axes; products of inertia are the entries of the matrix."""

    xx: Inertia = ZERO
    yy: Inertia = ZERO
    zz: Inertia = ZERO
    xy: Inertia = ZERO
    xz: Inertia = ZERO
    yz: Inertia = ZERO

    def matrix(self) -> np.ndarray:
        return np.array([[self.xx, self.xy, self.xz], [self.xy, self.yy, self.yz], [self.xz, self.yz, self.zz]])

    @model_validator(mode="after")
    def _belongs_to_a_body(self) -> InertiaTensor:
        """The moments of a real body are not negative, and none exceeds the sum of the other two (it may equal it)."""
        matrix = self.matrix().astype(float)
        if excess_moment(matrix) > 1e-9 * np.linalg.norm(matrix):
            found = ", ".join(f"{moment:.4g}" for moment in np.linalg.eigvalsh(matrix))
            raise PydanticCustomError(
                "inertia",
                f"found principal moments {found} kg m^2, which no body has: each is at most the sum of the others",
            )
        return self


class RigidOptions(Section):
    """Mass, its centre in the body frame, the inertia about it, and the named points."""

    mass: Mass
    centre: Point = (ZERO, ZERO, ZERO)
    inertia: InertiaTensor = InertiaTensor()
    nodes: dict[str, Point] = Field(min_length=1)


class RigidReducer(Reducer[RigidOptions]):
    description: ClassVar[str] = "rigid body from mass, inertia and named points (no file)"
    Options: ClassVar[type[Section]] = RigidOptions
    needs_source = False
    gives = "reduced"

    def read(self, part: PartRequest[RigidOptions]) -> SuperElement:
        """Six coordinates, the motion of the mass centre; node j moves by X(r_j - c). Inertia may be zero."""
        options = part.options
        centre = np.array(options.centre, dtype=float)
        positions = np.array(list(options.nodes.values()), dtype=float)
        mass = np.zeros((6, 6))
        mass[:3, :3] = options.mass * np.eye(3)
        mass[3:, 3:] = options.inertia.matrix()
        return SuperElement(
            stiffness=np.zeros((6, 6)),
            mass=mass,
            nodes=tuple(options.nodes),
            positions=positions,
            motions=transfer(positions - centre),
            labels=node_labels("centre"),
            provenance={"name": part.name},
        )
