"""Reduction of a part to a contact that travels, in coordinates that are smooth functions of where it is.

At every station the reduced space holds the part's static shapes for all of its nodes, as Craig-Bampton's does. Its
modes are those with the travelling contact released and the other nodes held: modes with the contact held would
localise to one side of it or the other, and change places along the stroke.
"""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_array, eye_array, vstack

from ..arrays import BoolArray, FloatArray
from ..finite_elements import FiniteElementModel
from .coupling import Tie, averaging_matrix, check_ties, rigidified
from .craig_bampton import HeldPart, Reduction, fixed_interface_modes, hold, response, static_modes
from .from_model import to_element
from .super_element import SuperElement

logger = logging.getLogger("prs_model")


@dataclass(frozen=True, eq=False)
class Released:
    """A part held at its other nodes, its contact released: static shapes (n', 6 k) of those nodes, and modes (n', p).

    Rigid contacts are stiff where they are: projection (n, n') leads from the DOFs of the part so stiffened to all.
    """

    part: HeldPart
    projection: csr_array
    statics: FloatArray
    modes: FloatArray


def reduction_per_station(
    model: FiniteElementModel,
    ties: Sequence[Sequence[Tie]],
    moving: BoolArray,
    n_modes: int,
    grounded: bool,
    basis: str = "craig-bampton",
) -> tuple[tuple[SuperElement, ...], FloatArray]:
    """One super-element per station and the products V_i^T M V_j (s, s, n, n) of their bases.

    ties: of every station; moving (k,): which of them travel.

    Travelling coordinates are the motion of one point r_0 of the body, so that a rigid motion has the same coordinates
    everywhere; the node's motion is X(r - r_0) of them. Averaged contacts need one factorization for all stations,
    rigid ones one for each.
    """
    fixed = [tie for tie, moves in zip(ties[0], moving, strict=True) if not moves]
    references = np.mean([[tie.position for tie in station] for station in ties], axis=0)
    released: Released | None = None
    elements, bases = [], []
    for index, station in enumerate(ties):
        logger.info("%s: station %d of %d", model.name, index + 1, len(ties))
        check_ties(model, station)
        contact = [replace(tie, position=r) for tie, r, moves in zip(station, references, moving, strict=True) if moves]
        if released is None or any(tie.coupling == "rigid" for tie in contact):
            released = _release(model, fixed, contact, n_modes, released)
        reduction = _reduction(model, released, _contact_motion(model, released, contact), moving)
        arms = np.array([tie.position for tie in station]) - references
        kind = {"modes": "contact released", "basis": basis}
        elements.append(to_element(model, station, reduction, grounded=grounded, arms=arms, **kind))
        bases.append(reduction.basis)
    images = [model.mass @ basis for basis in bases]
    return tuple(elements), np.array([[basis.T @ image for image in images] for basis in bases])


def _release(
    model: FiniteElementModel, fixed: Sequence[Tie], contact: Sequence[Tie], n_modes: int, previous: Released | None
) -> Released:
    stiffened, projection = model, csr_array(eye_array(model.size))
    for tie in contact:
        if tie.coupling == "rigid":
            stiffened, step = rigidified(stiffened, tie)
            projection = csr_array(projection @ step)
    part = hold(stiffened, fixed)
    modes = fixed_interface_modes(part, n_modes)
    if previous is not None and n_modes:
        earlier = np.asarray(previous.projection @ previous.modes)
        modes = modes @ _alignment(model, np.asarray(projection @ modes), earlier)
    return Released(part, projection, static_modes(part), modes)


def _alignment(model: FiniteElementModel, modes: FloatArray, previous: FloatArray) -> FloatArray:
    """Q (p, p), orthogonal: min |Phi Q - Phi_previous| in the mass inner product (Procrustes)."""
    left, likeness, right = np.linalg.svd(modes.T @ (model.mass @ previous))
    if likeness[-1] < 0.5:
        logger.warning(
            "%s: its modes change between two stations (likeness %.2f of 1); "
            "use closer stations or another number of modes",
            model.name,
            likeness[-1],
        )
    return np.asarray(left @ right)


def _contact_motion(model: FiniteElementModel, released: Released, contact: Sequence[Tie]) -> csr_array:
    """(6 c, n'): the motion of the contact's nodes from the DOFs of the released part."""
    stiffened = released.part.model
    rigid_node = len(model.coordinates)
    rows = []
    for tie in contact:
        if tie.coupling == "rigid":
            rows.append(csr_array(eye_array(stiffened.size, format="csr")[stiffened.rows[rigid_node]]))
            rigid_node += 1
        else:
            rows.append(averaging_matrix(stiffened, tie))
    return csr_array(vstack(rows))


def _reduction(model: FiniteElementModel, released: Released, motion: csr_array, moving: BoolArray) -> Reduction:
    """The space [Psi, A, Phi] of static shapes, responses to contact forces and modes, in physical coordinates.

    With D the contact's motion, C = D Psi, Z = D Phi and the residual response A_r = A - Phi Lambda^-1 Z^T, the shape
    of a unit contact motion is S = A_r (D A_r)^-1, and the basis [Psi - S C, S, Phi - S Z].
    """
    part, statics, modes = released.part, released.statics, released.modes
    stiffness = part.model.stiffness
    shapes = response(part, motion.T.toarray())
    shapes = shapes - modes @ np.linalg.solve(modes.T @ (stiffness @ modes), (motion @ modes).T)
    unit = shapes @ np.linalg.inv(motion @ shapes)
    nodes = np.empty((len(shapes), 6 * len(moving)))
    nodes[:, np.repeat(~moving, 6)], nodes[:, np.repeat(moving, 6)] = statics - unit @ (motion @ statics), unit
    basis = np.hstack([nodes, modes - unit @ (motion @ modes)])
    matrices = [basis.T @ (matrix @ basis) for matrix in (stiffness, part.model.mass)]
    reduced, mass = ((matrix + matrix.T) / 2.0 for matrix in matrices)
    return Reduction(np.asarray(released.projection @ basis), reduced, mass, modes.shape[1])
