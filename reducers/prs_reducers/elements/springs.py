"""Springs between two points of a part, or a point and the ground, that leave rigid motion alone exactly."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from pydantic import model_validator

from prs_model.arrays import FloatArray
from prs_model.description.quantity import Stiffness
from prs_model.description.schema import AXES, DiagonalStiffness, Point, Section, StiffnessLaw
from prs_model.finite_elements.rigid_motion import transfer

from .named_points import Direction, local_axes, refuse

GROUND = "ground"
SYMMETRIC, DEFINITE = 1e-6, 1e-9


class Spring(Section):
    """What holds two nodes together at one point, or a node to the ground: `axial` between them, or `stiffness`.

    stiffness: per axis, what is left out is zero, or a 6 x 6 matrix. at: where it acts (default: halfway, or the node
    that is held to the ground); both nodes reach there rigidly. along, up: its x axis (default: the body's axes) and
    where its z axis points.
    """

    between: tuple[str, str]
    axial: Stiffness | None = None
    stiffness: StiffnessLaw | None = None
    at: Point | None = None
    along: Direction | None = None
    up: Direction | None = None

    @model_validator(mode="after")
    def _one_law(self) -> Spring:
        if (self.axial is None) == (self.stiffness is None):
            raise refuse((), "found both or neither, expected 'axial' or 'stiffness'")
        place = "axial" if self.stiffness is None else "stiffness"
        law = self.law()
        if not np.all(np.isfinite(law)):
            raise refuse(
                (place,), "found rigid, expected a number: what does not move apart is one node, with both masses"
            )
        scale = np.sqrt(np.abs(np.diag(law)))
        scale[scale == 0.0] = 1.0
        scaled = law / np.outer(scale, scale)
        if np.max(np.abs(scaled - scaled.T)) > SYMMETRIC:
            raise refuse((place,), "found different entries on both sides of the diagonal, expected a symmetric matrix")
        if np.linalg.eigvalsh(scaled)[0] < -DEFINITE:
            raise refuse((place,), "found a matrix with a negative eigenvalue, expected none; check signs")
        if self.up is not None and self.along is None:
            raise refuse(("up",), "found no 'along' beside it, expected both")
        if self.along is not None:
            self._axes_of(np.array(self.along, dtype=float))
        if self.axial is not None and (self.along, self.at) != (None, None) and GROUND not in self.between:
            raise refuse(("axial",), "found 'along' or 'at' beside it, expected none: it acts on the line of its nodes")
        if self.axial is not None and GROUND in self.between and self.along is None:
            raise refuse(("axial",), "found no 'along', expected the direction in which it holds the node")
        return self

    def law(self) -> FloatArray:
        """(6, 6) in its own axes [SI]; infinite entries where it is rigid."""
        if self.axial is not None:
            return np.diag([float(self.axial), *np.zeros(5)])
        if isinstance(self.stiffness, DiagonalStiffness):
            return np.diag([float(getattr(self.stiffness, axis) or 0.0) for axis in AXES])
        return np.array(self.stiffness, dtype=float)

    def _axes_of(self, along: FloatArray) -> FloatArray:
        try:
            return local_axes(along, self.up)
        except ValueError as error:
            raise refuse(("up",), str(error)) from error

    def action(self, nodes: Mapping[str, FloatArray]) -> dict[str, FloatArray]:
        """For each of its nodes, (6, 6): the spring's stretch in its own axes from the node's motion.

        Its ends at p, d = X(p - r_b) u_b - X(p - r_a) u_a apart, coincide in every rigid motion.
        nodes: places (3,) [m].
        """
        held = [node for node in self.between if node != GROUND]
        places = np.array([nodes[node] for node in held])
        turn = np.kron(np.eye(2), self._axes(places).T)
        sign = {self.between[0]: -1.0, self.between[1]: 1.0}
        arms = self._arms(places)
        return {node: sign[node] * turn @ transfer(arm) for node, arm in zip(held, arms, strict=True)}

    def _arms(self, places: FloatArray) -> FloatArray:
        """From each node to where the spring acts; an axial one acts all along its line, so at the nodes."""
        if self.at is not None:
            return np.array(self.at, dtype=float) - places
        return np.zeros_like(places) if self.axial is not None else places.mean(axis=0) - places

    def _axes(self, places: FloatArray) -> FloatArray:
        if self.along is not None:
            return self._axes_of(np.array(self.along, dtype=float))
        return local_axes(places[1] - places[0], None) if self.axial is not None else np.eye(3)
