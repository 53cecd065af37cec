"""What parts made of named points share: their options, the masses on them, axes along lines, pieces."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import ArrayLike
from pydantic import ValidationError
from pydantic_core import PydanticCustomError
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

from prs_model.arrays import FloatArray
from prs_model.description.problems import Place, listed, not_known
from prs_model.description.quantity import Mass, Number
from prs_model.description.schema import Point, Section
from prs_model.finite_elements.mass import MassProperties
from prs_model.finite_elements.rigid_motion import transfer

from ..rigid import InertiaTensor

Direction = tuple[Number, Number, Number]
PARALLEL = 1e-3  # sine of the smallest angle between two directions that span a plane


class PointMass(Section):
    """A rigid body on a node: its mass, the inertia about its centre, and where that is (default: at the node)."""

    mass: Mass
    inertia: InertiaTensor = InertiaTensor()
    centre: Point | None = None

    def matrix(self, node: FloatArray) -> FloatArray:
        """(6, 6): its mass in the motion of the node, which stands at (3,) [m]."""
        arm = np.zeros(3) if self.centre is None else np.array(self.centre, dtype=float) - node
        rigid = MassProperties(float(self.mass), np.zeros(3), self.inertia.matrix().astype(float)).rigid_mass()
        return np.asarray(transfer(arm).T @ rigid @ transfer(arm))


def local_axes(along: ArrayLike, up: ArrayLike | None) -> FloatArray:
    """(3, 3), columns x, y, z: x along the direction, z towards `up` as far as it is square to x.

    Without `up`, the body's z axis, or its x axis for a direction along z. Raises ValueError when `up` is parallel.
    """
    x = _unit(np.asarray(along, dtype=float))
    upwards = _unit(np.asarray(_default_up(x) if up is None else up, dtype=float))
    y = np.cross(upwards, x)
    if not np.linalg.norm(y) > PARALLEL:
        raise ValueError(
            "found a direction that is zero or along local x, expected one across it, to which local z points"
        )
    y = _unit(y)
    return np.column_stack([x, y, np.cross(x, y)])


def refuse(place: Place, message: str) -> ValidationError:
    """The error of a section's validator for one of its entries, at `place` within the section."""
    error = PydanticCustomError("entry", "{text}", {"text": message})
    return ValidationError.from_exception_data("entry", [{"type": error, "loc": place, "input": None}])


def check_known(place: Place, what: str, names: Iterable[str], known: Iterable[str]) -> None:
    """Raises ValidationError for a name that is none of the known ones."""
    known = list(known)
    for name in names:
        if name not in known:
            raise refuse(place, not_known(what, name, known))


def check_ends(place: Place, between: tuple[str, str], nodes: Iterable[str]) -> None:
    """Raises ValidationError unless two different nodes are named."""
    check_known((*place, "between"), "a node", between, nodes)
    if between[0] == between[1]:
        raise refuse((*place, "between"), f"found '{between[0]}' twice, expected two nodes")


def check_one_piece(nodes: Sequence[str], links: Iterable[tuple[str, str]], what: str) -> None:
    """Raises ValidationError when the links do not join all nodes to one part."""
    place = {name: index for index, name in enumerate(nodes)}
    ends = np.array([[place[a], place[b]] for a, b in links], dtype=np.int64).reshape(-1, 2).T
    graph = coo_array((np.ones(ends.shape[1]), (ends[0], ends[1])), shape=(len(nodes), len(nodes)))
    pieces, piece = connected_components(graph, directed=False)
    if pieces > 1:
        apart = listed([name for name, each in zip(nodes, piece, strict=True) if each != piece[0]])
        raise refuse((what,), f"found none that join {apart} to {nodes[0]}; add one, or remove what is not of the part")


def _default_up(x: FloatArray) -> FloatArray:
    return np.asarray(np.eye(3)[2 if np.linalg.norm(x[:2]) > PARALLEL else 0])


def _unit(vector: FloatArray) -> FloatArray:
    length = np.linalg.norm(vector)
    return np.asarray(vector / length) if length > 0.0 else vector
