"""The physics gate of full matrices: what it can see before a reduction hides it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from scipy.sparse import csr_array

from ..finite_elements import FiniteElementModel
from .gate import BODY, RIGID, SYMMETRY, Check, GateReport, passed

HELD = "if the part is held to the ground in its file, say 'grounded: true'"
HELD_TWICE = (
    "if the part is held in its file already, it cannot be clamped here too: leave 'clamped' out, or export it free"
)


def check_model(model: FiniteElementModel, *, grounded: bool, clamped: bool = False) -> GateReport:
    """Run every check. Raises PhysicsError for the first that fails.

    grounded: nodes are held, so rigid motion costs energy and the held nodes' mass is missing; clamped: they will be
    held here, so that the file has the free part.
    """
    return passed(model.name, _checks(model, free=clamped or not grounded, advice=HELD_TWICE if clamped else HELD))


def _checks(model: FiniteElementModel, free: bool, advice: str) -> Iterator[Check]:
    yield _symmetry("stiffness is symmetric", model.stiffness)
    yield _symmetry("mass is symmetric", model.mass)
    yield _negative("stiffness", model.stiffness)
    yield _negative("mass", model.mass)
    yield _no_mass(model.mass)
    if free:
        yield _free(model, advice)
        yield _equal_masses(model)


def _symmetry(name: str, matrix: csr_array) -> Check:
    figure = _ratio(_norm(csr_array(matrix - matrix.T)), _norm(matrix))
    cause = "only one triangle was read, or rows and columns are in different orders: check the export's format"
    return Check(name, figure, SYMMETRY, cause)


def _negative(name: str, matrix: csr_array) -> Check:
    bad = int(np.count_nonzero(matrix.diagonal() < 0.0))
    return Check(
        f"negative diagonal entries of the {name}", bad, 0, "a flipped sign or a damaged file: export it again"
    )


def _no_mass(mass: csr_array) -> Check:
    missing = int(not np.any(mass.diagonal() > 0.0))
    cause = "the mass matrix is empty: give the material a density, or name the file with the mass"
    return Check("the part has no mass", missing, 0, cause)


def _free(model: FiniteElementModel, advice: str) -> Check:
    """Force of each rigid motion about the nodes' centre, over what single entries of K would give."""
    phi = model.rigid_body_modes(about=model.coordinates.mean(axis=0))
    force = np.linalg.norm(model.stiffness @ phi, axis=0) / np.linalg.norm(phi, axis=0)
    figure = float(np.max(force, initial=0.0) / (_norm(model.stiffness) or 1.0))
    cause = (
        "rigid motion costs energy: rows in another order, output frames, nodes that moved, or a node that is held; "
        + advice
    )
    return Check("rigid motion is free, |K phi| / |K| |phi|", figure, RIGID, cause)


def _equal_masses(model: FiniteElementModel) -> Check:
    phi = model.rigid_body_modes()[:, :3]
    masses = phi.T @ (model.mass @ phi)
    mean = float(np.trace(masses)) / 3.0
    figure = _ratio(float(np.linalg.norm(masses - mean * np.eye(3))), abs(mean))
    cause = "the part weighs differently along x, y and z: rows in another order, or a node's mass is missing"
    return Check("three equal translational masses", figure, BODY, cause)


def _norm(matrix: csr_array) -> float:
    return float(np.linalg.norm(matrix.data))


def _ratio(part: float, whole: float) -> float:
    return part / whole if whole > 0.0 else part
