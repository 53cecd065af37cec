"""Few motions of one part with all its DOFs, on which its matrices are projected.

Orthonormal in A = K - s M, which is positive definite where K or M alone are not.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg import eigh

from ..arrays import FloatArray
from ..finite_elements.rigid_motion import transfer
from ..reduction.super_element import SuperElement, node_labels
from ..reduction.surface import Surface
from .part import CompletePart

NEW = 1e-12  # of a motion's energy: below, what is left when all known motions are taken out of it is round-off
APART = 1e-8  # of the energy of new motions: below, a combination of them is nothing of its own
LIGHT = 1e-2  # of the most mass for the same energy: what has less is not followed further


@dataclass(frozen=True, eq=False)
class Subspace:
    """Motions u = V c of a part: V (n, r), the first six rigid unless it is grounded, with K_r, M_r (r, r)."""

    part: CompletePart
    vectors: FloatArray
    stiffness: FloatArray
    mass: FloatArray

    @property
    def size(self) -> int:
        """Number of motions."""
        return len(self.mass)

    def element(self) -> SuperElement:
        """The part on the coordinates c."""
        return replace(
            self.part.stand_in(),
            stiffness=self.stiffness,
            mass=self.mass,
            motions=(self.part.outputs @ self.vectors).reshape(len(self.part.ties), 6, self.size),
            labels=tuple(f"shape {i + 1}" for i in range(self.size)),
        )


def rigid_motions(part: CompletePart) -> Subspace:
    """The six rigid motions of a part; of a grounded one none."""
    nothing = Subspace(part, np.zeros((part.size, 0)), np.zeros((0, 0)), np.zeros((0, 0)))
    return nothing if part.grounded else enlarged(nothing, part.model.rigid_body_modes())


def response_space(part: CompletePart, depth: int) -> Subspace:
    """Rigid motions, and the block Krylov space of A^-1 M from the responses to loads on the nodes.

    Load-dependent Ritz vectors (E. L. Wilson, M.-W. Yuan, J. M. Dickens, Dynamic analysis by direct superposition of
    Ritz vectors, Earthquake Engineering & Structural Dynamics 10, 1982). One load without order is among the first, so
    that motions that no node feels are not missed.
    """
    space = rigid_motions(part)
    chance = np.random.default_rng(0).standard_normal((part.size, 1))
    shapes = np.hstack([part.responses, part.solve(part.model.mass @ chance)])
    for level in range(depth):
        known = space.size
        space = enlarged(space, shapes)
        if space.size == known:
            break
        if level + 1 < depth:
            shapes = part.solve(part.model.mass @ _slow(space, known))
    return space


def _slow(space: Subspace, known: int) -> FloatArray:
    """Of the motions beyond those known, combinations with much mass for their energy: the others hardly respond."""
    share, turn = eigh(space.mass[known:, known:])
    return np.asarray(space.vectors[:, known:] @ turn[:, share > LIGHT * share[-1]])


def enlarged(space: Subspace, shapes: FloatArray) -> Subspace:
    """The subspace with what is new in `shapes` (n, c), never of more motions than the part has DOFs."""
    if space.size == space.part.size:
        return space
    model, shift, vectors = space.part.model, space.part.shift, space.vectors
    loads = model.stiffness @ shapes - shift * (model.mass @ shapes)
    before = np.einsum("ij,ij->j", shapes, loads)
    shapes = shapes - vectors @ (vectors.T @ loads)
    strained, moved = model.stiffness @ shapes, model.mass @ shapes
    energy = np.einsum("ij,ij->j", shapes, strained - shift * moved)
    new = np.flatnonzero(energy > NEW * before)
    scale = 1.0 / np.sqrt(energy[new])
    weight, turn = eigh((shapes[:, new] * scale).T @ (strained - shift * moved)[:, new] * scale)
    apart = np.flatnonzero(weight > APART)[space.size - space.part.size :]
    change = np.zeros((len(energy), len(apart)))
    change[new] = scale[:, None] * turn[:, apart] / np.sqrt(weight[apart])
    added = shapes @ change
    return Subspace(
        part=space.part,
        vectors=np.hstack([vectors, added]),
        stiffness=_bordered(space.stiffness, vectors, added, strained @ change),
        mass=_bordered(space.mass, vectors, added, moved @ change),
    )


def pictured(space: Subspace) -> SuperElement:
    """The part on the same motions as an element with a picture surface and, unless grounded, rigid coordinates.

    These are the motion of the body's origin; the other coordinates leave the first node where it is.
    """
    part, element = space.part, space.element()
    change, labels = np.eye(space.size), element.labels
    if not part.grounded:
        rigid = np.linalg.lstsq(
            element.motions[:, :, :6].reshape(-1, 6), transfer(element.positions).reshape(-1, 6), rcond=None
        )[0]
        first = np.linalg.solve(element.motions[0, :, :6], element.motions[0, :, 6:])
        change[:6, :6], change[:6, 6:] = rigid, -first
        labels = (*node_labels("origin"), *labels[6:])
    return replace(
        element,
        stiffness=change.T @ element.stiffness @ change,
        mass=change.T @ element.mass @ change,
        motions=element.motions @ change,
        n_modes=space.size - (0 if part.grounded else 6),
        labels=labels,
        surface=_surface(part, space.vectors @ change),
    )


def _bordered(block: FloatArray, vectors: FloatArray, added: FloatArray, image: FloatArray) -> FloatArray:
    """V^T K V of a basis with more columns; image: K times these."""
    border, corner = vectors.T @ image, added.T @ image
    return np.block([[block, border], [border.T, (corner + corner.T) / 2.0]])


def _surface(part: CompletePart, basis: FloatArray) -> Surface | None:
    if part.skin is None:
        return None
    recovery = (part.sight @ basis).reshape(-1, 3, basis.shape[1])
    return Surface(part.skin.points, part.skin.triangles, recovery.astype(np.float32))
