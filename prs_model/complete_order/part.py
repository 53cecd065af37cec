"""One part with all its DOFs: its interfaces as condensation nodes, and its response to loads on them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import reduce

import numpy as np
from scipy.sparse import csr_array, vstack

from ..arrays import FloatArray
from ..finite_elements import FiniteElementModel
from ..linear_algebra import Solve, factorize
from ..reduction.coupling import Tie, averaging_matrix, check_ties, rigidified
from ..reduction.super_element import SuperElement, node_labels


@dataclass(frozen=True, eq=False)
class CompletePart:
    """A part (n DOFs) with k condensation nodes, and A = K - s M factorized.

    model: with rigid ties' nodes replaced by one node each. outputs: D (6 k, n), the nodes' motions U = D u. responses:
    Y = A^-1 D^T (n, 6 k). flexibility: H = D Y (6 k, 6 k). inertia: Y^T M Y (6 k, 6 k). solve: b -> A^-1 b.
    """

    model: FiniteElementModel
    ties: tuple[Tie, ...]
    outputs: csr_array
    responses: FloatArray
    flexibility: FloatArray
    inertia: FloatArray
    solve: Solve

    @property
    def size(self) -> int:
        return self.model.size

    def stand_in(self, grounded: bool) -> SuperElement:
        """The nodes as the synthesis wants them: an element that is nothing but its nodes, with unit mass."""
        k = len(self.ties)
        return SuperElement(
            stiffness=np.zeros((6 * k, 6 * k)),
            mass=np.eye(6 * k),
            nodes=tuple(tie.node for tie in self.ties),
            positions=np.array([tie.position for tie in self.ties]),
            motions=np.eye(6 * k).reshape(k, 6, 6 * k),
            grounded=grounded,
            labels=tuple(label for tie in self.ties for label in node_labels(tie.node)),
            provenance=self.model.provenance,
        )


@dataclass(frozen=True, eq=False)
class Factorized:
    """A model with the solution of K - s M."""

    model: FiniteElementModel
    solve: Solve


def factorized(model: FiniteElementModel, shift: float) -> Factorized:
    """K - s M of a model, s < 0 [rad^2/s^2]. Raises numpy.linalg.LinAlgError when it is singular."""
    return Factorized(model, factorize(csr_array(model.stiffness - shift * model.mass)))


def with_interfaces(part: Factorized, ties: Sequence[Tie], shift: float) -> CompletePart:
    """A part held at ties. Averaged ones leave the factorization as it is, rigid ones need one of their own.

    Raises PartFileError for ties that cannot hold.
    """
    check_ties(part.model, ties)
    model, solve = part.model, part.solve
    rigid = [tie for tie in ties if tie.coupling == "rigid"]
    if rigid:
        model = reduce(lambda each, tie: rigidified(each, tie)[0], rigid, model)
        solve = factorized(model, shift).solve
    first = len(part.model.coordinates)
    places = {tie.node: first + index for index, tie in enumerate(rigid)}
    outputs = csr_array(vstack([_output(model, tie, places.get(tie.node)) for tie in ties]))
    responses = solve(np.ascontiguousarray(outputs.T.toarray()))
    flexibility = outputs @ responses
    return CompletePart(
        model=model,
        ties=tuple(ties),
        outputs=outputs,
        responses=responses,
        flexibility=(flexibility + flexibility.T) / 2.0,
        inertia=responses.T @ (model.mass @ responses),
        solve=solve,
    )


def _output(model: FiniteElementModel, tie: Tie, place: int | None) -> csr_array:
    """D (6, n) of one tie; `place` is the node that a rigid tie has become."""
    if place is None:
        return averaging_matrix(model, tie)
    rows = model.rows[place]
    return csr_array((np.ones(6), (np.arange(6), rows)), shape=(6, model.size))
