"""Lumped parts: rigid masses on named nodes, held together by springs."""

from __future__ import annotations

import logging
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field, model_validator

from prs_model.arrays import BoolArray, FloatArray
from prs_model.description.problems import Place
from prs_model.description.schema import Point, Section
from prs_model.plugins import PartRequest, Reducer
from prs_model.reduction import SuperElement
from prs_model.reduction.super_element import node_labels, rigid_body_modes

from .elements.named_points import PointMass, check_ends, check_known, check_one_piece, refuse
from .elements.springs import GROUND, Spring

logger = logging.getLogger("prs_model")

FREE = 1e-10


class LumpedOptions(Section):
    """Named nodes in the body frame, the masses on some of them, and the springs between them or to ``ground``."""

    nodes: Annotated[dict[str, Point], Field(min_length=1)]
    masses: dict[str, PointMass] = Field(default={})
    springs: tuple[Spring, ...] = ()

    @model_validator(mode="after")
    def _is_one_part(self) -> LumpedOptions:
        if GROUND in self.nodes:
            raise refuse(("nodes",), f"found a node named '{GROUND}', expected another name: springs go to the ground")
        check_known(("masses",), "a node", self.masses, self.nodes)
        places = self.places()
        for index, spring in enumerate(self.springs):
            place: Place = ("springs", index)
            check_ends(place, spring.between, [*self.nodes, GROUND])
            first, last = (places.get(node) for node in spring.between)
            if spring.axial is not None and first is not None and last is not None and np.array_equal(first, last):
                raise refuse((*place, "axial"), "found two nodes at one place, expected a line between them")
        check_one_piece([*self.nodes, *self._ground()], [spring.between for spring in self.springs], "springs")
        return self

    def _ground(self) -> tuple[str, ...]:
        """The ground, where a spring goes there: it joins pieces as a node does."""
        return (GROUND,) if any(GROUND in spring.between for spring in self.springs) else ()

    def places(self) -> dict[str, FloatArray]:
        """Where each node is, (3,) [m]."""
        return {name: np.array(point, dtype=float) for name, point in self.nodes.items()}


class LumpedReducer(Reducer[LumpedOptions]):
    description: ClassVar[str] = "rigid masses on named nodes, held together by springs (no file)"
    Options: ClassVar[type[Section]] = LumpedOptions
    needs_source = False
    gives = "reduced"

    def read(self, part: PartRequest[LumpedOptions]) -> SuperElement:
        """Six coordinates a node, nothing condensed. Rotations that no mass and no spring meets are left out.

        A warning tells of inner motions without stiffness, which the joints then have to hold.
        """
        stiffness, mass = lumped_matrices(part.options)
        there = _present(stiffness, mass)
        positions = np.array(list(part.options.places().values()))
        labels = np.array([label for name in part.options.nodes for label in node_labels(name)])
        element = SuperElement(
            stiffness=stiffness[np.ix_(there, there)],
            mass=mass[np.ix_(there, there)],
            nodes=tuple(part.options.nodes),
            positions=positions,
            motions=np.eye(len(there))[:, there].reshape(len(positions), 6, -1),
            labels=tuple(labels[there].tolist()),
            provenance={"name": part.name},
        )
        _warn_of_loose_motions(element)
        return element


def lumped_matrices(options: LumpedOptions) -> tuple[FloatArray, FloatArray]:
    """K and M (6 k, 6 k) over all motions of k nodes [SI]: sums of G^T C G over springs, of X^T M X over masses."""
    places = options.places()
    rows = {name: slice(6 * index, 6 * index + 6) for index, name in enumerate(places)}
    K, M = np.zeros((6 * len(rows),) * 2), np.zeros((6 * len(rows),) * 2)
    for spring in options.springs:
        law = (spring.law() + spring.law().T) / 2.0
        action = spring.action(places)
        for one, left in action.items():
            for other, right in action.items():
                K[rows[one], rows[other]] += left.T @ law @ right
    for name, mass in options.masses.items():
        M[rows[name], rows[name]] += mass.matrix(places[name])
    return (K + K.T) / 2.0, (M + M.T) / 2.0


def _present(stiffness: FloatArray, mass: FloatArray) -> BoolArray:
    """(n,): translations, and rotations that meet a spring or a mass."""
    rotates = np.arange(len(stiffness)) % 6 >= 3
    return np.asarray(~rotates | np.any(stiffness != 0.0, axis=1) | np.any(mass != 0.0, axis=1))


def _warn_of_loose_motions(element: SuperElement) -> None:
    scale = np.sqrt(np.diag(element.stiffness))
    scale[scale == 0.0] = 1.0
    soft = np.count_nonzero(np.linalg.eigvalsh(element.stiffness / np.outer(scale, scale)) < FREE)
    rigid = rigid_body_modes(element.motions, element.positions)
    force = np.linalg.norm(element.stiffness @ rigid)
    free = (
        np.linalg.matrix_rank(rigid) if force <= FREE * np.linalg.norm(element.stiffness) * np.linalg.norm(rigid) else 0
    )
    if soft > free:
        logger.warning(
            "%s: %d motions of its nodes meet no spring; the joints have to hold them, or springs are missing",
            *(element.name, soft - free),
        )
