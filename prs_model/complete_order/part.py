"""One part with all its DOFs: its interfaces as condensation nodes, and its response to loads on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce

import numpy as np
from scipy.sparse import csr_array, eye_array, vstack

from ..arrays import FloatArray
from ..finite_elements import FiniteElementModel
from ..linear_algebra import Solve, factorize
from ..reduction.coupling import Tie, averaging_matrix, check_ties, rigidified
from ..reduction.super_element import SuperElement, node_labels
from ..reduction.surface import Skin


@dataclass(frozen=True, eq=False)
class CompletePart:
    """A part (n DOFs) with k condensation nodes, and A = K - s M factorized, s = `shift` [rad^2/s^2].

    model: with rigid ties' nodes replaced by one node each. outputs: D (6 k, n), the nodes' motions U = D u. solve:
    b -> A^-1 b. skin: points of the picture surface; sight: (3 p, n), their translations. grounded: held to the ground.
    """

    model: FiniteElementModel
    ties: tuple[Tie, ...]
    outputs: csr_array
    shift: float
    solve: Solve
    skin: Skin | None
    sight: csr_array
    grounded: bool

    @property
    def size(self) -> int:
        """Number of DOFs."""
        return self.model.size

    @cached_property
    def responses(self) -> FloatArray:
        """Y = A^-1 D^T (n, 6 k)."""
        return self.solve(self.outputs.T.toarray())

    @cached_property
    def flexibility(self) -> FloatArray:
        """H = D Y (6 k, 6 k)."""
        flexibility = self.outputs @ self.responses
        return np.asarray((flexibility + flexibility.T) / 2.0)

    def stand_in(self) -> SuperElement:
        """The nodes as the synthesis wants them: an element that is nothing but its nodes, with unit mass."""
        k = len(self.ties)
        return SuperElement(
            stiffness=np.zeros((6 * k, 6 * k)),
            mass=np.eye(6 * k),
            nodes=tuple(tie.node for tie in self.ties),
            positions=np.array([tie.position for tie in self.ties]),
            motions=np.eye(6 * k).reshape(k, 6, 6 * k),
            grounded=self.grounded,
            labels=tuple(label for tie in self.ties for label in node_labels(tie.node)),
            provenance=self.model.provenance,
        )


def shifted(model: FiniteElementModel, shift: float) -> Solve:
    """b -> (K - s M)^-1 b of a model, s < 0 [rad^2/s^2]. Raises numpy.linalg.LinAlgError when it is singular."""
    return factorize(csr_array(model.stiffness - shift * model.mass))


def tied_part(
    model: FiniteElementModel,
    ties: Sequence[Tie],
    skin: Skin | None,
    shift: float,
    free: Callable[[], Solve],
    *,
    grounded: bool,
) -> CompletePart:
    """A part held at ties. Averaged ones use the factorization `free` of the part without ties, rigid ones their own.

    Raises PartFileError for ties that cannot hold.
    """
    check_ties(model, ties)
    rigid = [tie for tie in ties if tie.coupling == "rigid"]
    stiffened, projection = reduce(_with_rigid, rigid, (model, csr_array(eye_array(model.size, format="csr"))))
    places = {tie.node: len(model.coordinates) + index for index, tie in enumerate(rigid)}
    return CompletePart(
        model=stiffened,
        ties=tuple(ties),
        outputs=csr_array(vstack([_output(stiffened, tie, places.get(tie.node)) for tie in ties])),
        shift=shift,
        solve=shifted(stiffened, shift) if rigid else free(),
        skin=skin,
        sight=_sight(model, skin, projection),
        grounded=grounded,
    )


def _with_rigid(so_far: tuple[FiniteElementModel, csr_array], tie: Tie) -> tuple[FiniteElementModel, csr_array]:
    """The model with one more rigid tie, and what leads from its DOFs to those of the part without ties."""
    model, projection = so_far
    stiffened, step = rigidified(model, tie)
    return stiffened, csr_array(projection @ step)


def _output(model: FiniteElementModel, tie: Tie, place: int | None) -> csr_array:
    """D (6, n) of one tie; `place` is the node that a rigid tie has become."""
    if place is None:
        return averaging_matrix(model, tie)
    rows = model.rows[place]
    return csr_array((np.ones(6), (np.arange(6), rows)), shape=(6, model.size))


def _sight(model: FiniteElementModel, skin: Skin | None, projection: csr_array) -> csr_array:
    rows = np.zeros(0, dtype=np.int64) if skin is None else skin.rows(model).ravel()
    seen = np.flatnonzero(rows >= 0)
    choice = csr_array((np.ones(len(seen)), (seen, rows[seen])), shape=(len(rows), model.size))
    return csr_array(choice @ projection)
