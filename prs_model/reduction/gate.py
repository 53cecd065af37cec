"""The physics gate: what no parser can notice (a permuted row, a flipped digit, wrong units) shows as wrong physics."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from ..errors import PhysicsError
from ..finite_elements.rigid_motion import transfer
from .super_element import SuperElement

SYMMETRY, DEFINITE, RIGID, TRANSLATION, MODAL = 1e-9, 1e-9, 1e-8, 1e-6, 1e-8


@dataclass(frozen=True)
class Check:
    """One check with its figure (relative) and the largest value allowed."""

    name: str
    figure: float
    limit: float
    cause: str

    @property
    def passed(self) -> bool:
        return self.figure <= self.limit


@dataclass(frozen=True)
class GateReport:
    """Every check that a super-element has passed."""

    subject: str
    checks: tuple[Check, ...]

    def __str__(self) -> str:
        lines = [f"{check.name:<46} {check.figure:9.2e}  (allowed {check.limit:.0e})" for check in self.checks]
        return "\n".join([f"{self.subject}: physics gate passed", *lines])


def check(element: SuperElement) -> GateReport:
    """Run every check. Raises PhysicsError for the first that fails."""
    passed = []
    for each in _checks(element):
        if not each.passed:
            raise PhysicsError(element.name, each.name, each.figure, each.limit, each.cause)
        passed.append(each)
    return GateReport(element.name, tuple(passed))


def _checks(element: SuperElement) -> Iterator[Check]:
    yield _finite(element)
    yield _symmetry("stiffness is symmetric", element.stiffness)
    yield _symmetry("mass is symmetric", element.mass)
    yield _definite("mass is not negative", element.mass, "a flipped sign or digit, or mass rows in another order")
    yield _definite(
        "stiffness is not negative", element.stiffness, "a flipped sign or digit, or a stress-stiffened part"
    )
    yield _rigid_motion(element)
    if element.grounded:
        yield _held(element)
    else:
        yield _free(element)
        yield _equal_masses(element)
    if element.provenance.get("modes") == "fixed-interface":
        yield _modal_block(element)


def _finite(element: SuperElement) -> Check:
    arrays = (element.stiffness, element.mass, element.positions, element.motions)
    bad = sum(int(np.count_nonzero(~np.isfinite(array))) for array in arrays)
    return Check("numbers that are not finite", bad, 0, "the file is damaged or a field overflowed: export it again")


def _symmetry(name: str, matrix: FloatArray) -> Check:
    figure = _ratio(np.linalg.norm(matrix - matrix.T), np.linalg.norm(matrix))
    cause = "only one triangle was read, or rows and columns are in different orders: check the export's format"
    return Check(name, figure, SYMMETRY, cause)


def _definite(name: str, matrix: FloatArray, cause: str) -> Check:
    """The lowest eigenvalue once every coordinate is scaled to a unit diagonal, so that units do not matter."""
    diagonal = np.diag(matrix)
    largest = float(np.max(np.abs(diagonal), initial=0.0))
    scale = 1.0 / np.sqrt(np.maximum(diagonal, 1e-12 * largest)) if largest > 0.0 else np.ones(len(matrix))
    scaled = (matrix + matrix.T) / 2.0 * np.outer(scale, scale)
    lowest = np.linalg.eigvalsh(scaled)[0] if len(matrix) else 0.0
    return Check(name, max(0.0, -float(lowest)), DEFINITE, f"{cause}: compare with the matrices in the part's solver")


def _rigid_motion(element: SuperElement) -> Check:
    rows = element.motions.reshape(-1, element.size)
    phi = element.rigid_body_modes()
    wanted = transfer(element.positions).reshape(-1, 6)
    present = np.any(rows != 0.0, axis=1)
    figure = _ratio(np.linalg.norm((rows @ phi - wanted)[present]), np.linalg.norm(wanted[present]))
    cause = "the nodes cannot move as one rigid body: check node positions, output frames and length units"
    return Check("nodes follow a rigid motion", figure, RIGID, cause)


def _rigid_residual(element: SuperElement) -> float:
    phi = element.rigid_body_modes()
    force, size = np.linalg.norm(element.stiffness @ phi, axis=0), np.linalg.norm(phi, axis=0)
    return float(max(map(_ratio, force, np.linalg.norm(element.stiffness) * size), default=0.0))


def _free(element: SuperElement) -> Check:
    cause = (
        "rigid motion costs energy: rows in another order, output frames, wrong length unit or a missing node; "
        "if the part is held to the ground, say 'grounded: true'"
    )
    return Check("rigid motion is free, |K phi| / |K| |phi|", _rigid_residual(element), RIGID, cause)


def _held(element: SuperElement) -> Check:
    free = 1.0 if _rigid_residual(element) < RIGID else 0.0
    cause = "'grounded: true' is said, but nothing holds the part: clamp a node set, or leave 'grounded' out"
    return Check("rigid motion is held", free, 0.0, cause)


def _equal_masses(element: SuperElement) -> Check:
    phi = element.rigid_body_modes()[:, :3]
    masses = phi.T @ element.mass @ phi
    mean = float(np.trace(masses)) / 3.0
    figure = _ratio(np.linalg.norm(masses - mean * np.eye(3)), abs(mean))
    cause = "the part weighs differently along x, y and z: rows in another order, or a node's mass is missing"
    return Check("three equal translational masses", figure, TRANSLATION, cause)


def _modal_block(element: SuperElement) -> Check:
    """Fixed-interface modes: mass-normalised and without elastic coupling to the nodes, as Craig-Bampton promises."""
    first = element.size - element.n_modes
    identity = np.linalg.norm(element.mass[first:, first:] - np.eye(element.n_modes))
    scale = np.linalg.norm(element.stiffness)
    figure = max(float(identity), _ratio(np.linalg.norm(element.stiffness[:first, first:]), scale))
    cause = "the trailing coordinates are not mass-normalised fixed-interface modes: check their number and order"
    return Check("modal block is as promised", figure, MODAL, cause)


def _ratio(part: float | np.floating, whole: float | np.floating) -> float:
    return float(part / whole) if whole > 0.0 else float(part)
