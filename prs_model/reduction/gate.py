"""The physics gate: what no parser can notice (a permuted row, a flipped digit, wrong units) shows as wrong physics."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from ..errors import PhysicsError
from ..finite_elements.mass import excess_moment, mass_properties
from ..finite_elements.rigid_motion import transfer
from .super_element import SuperElement, present_motions

SYMMETRY, DEFINITE, RIGID, HELD, BODY, MODAL = 1e-9, 1e-9, 1e-8, 1e-8, 1e-6, 1e-8
SOFT = 1e6  # s^-2: beside a stiffness that makes the mass oscillate this slowly, round-off does not count

JOINT_LOADED = "joint-loaded"  # a basis of the shapes that joints give a part: rigid motions only of a free one


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

    def __repr__(self) -> str:
        return str(self)

    def __str__(self) -> str:
        lines = [f"{check.name:<46} {check.figure:9.2e}  (allowed {check.limit:.0e})" for check in self.checks]
        return "\n".join([f"{self.subject}: physics gate passed", *lines])


def check(element: SuperElement) -> GateReport:
    """Run every check. Raises PhysicsError for the first that fails."""
    return passed(element.name, _checks(element))


def passed(subject: str, checks: Iterable[Check]) -> GateReport:
    """The report of checks that pass. Raises PhysicsError for the first that fails."""
    done = []
    for each in checks:
        if not each.passed:
            raise PhysicsError(subject, each.name, each.figure, each.limit, each.cause)
        done.append(each)
    return GateReport(subject, tuple(done))


def _checks(element: SuperElement) -> Iterator[Check]:
    yield _finite(element)
    yield _symmetry("stiffness is symmetric", element.stiffness)
    yield _symmetry("mass is symmetric", element.mass)
    cause = "a flipped sign or digit, or mass rows in another order"
    yield _definite("mass is not negative", element.mass, np.zeros(element.size), cause)
    soft, cause = SOFT * np.diag(element.mass), "a flipped sign or digit, or a stress-stiffened part"
    yield _definite("stiffness is not negative", element.stiffness, soft, cause)
    if element.grounded:
        if element.provenance.get("basis") != JOINT_LOADED:
            yield _rigid_motion(element)
            yield _held(element)
    else:
        yield _rigid_motion(element)
        yield _free(element)
        yield _equal_masses(element)
        yield _mass_of_a_body(element)
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


def _definite(name: str, matrix: FloatArray, floor: FloatArray, cause: str) -> Check:
    lowest = float(np.min(np.linalg.eigvalsh(_with_unit_diagonal(matrix, floor)[0]), initial=0.0))
    return Check(name, -lowest, DEFINITE, f"{cause}: compare with the matrices in the part's solver")


def _with_unit_diagonal(matrix: FloatArray, floor: FloatArray) -> tuple[FloatArray, FloatArray]:
    """A / s s^T and s (n,), the roots of the diagonal (of `floor` where that is more), so that units do not matter."""
    diagonal = np.diag(matrix)
    least = np.maximum(floor, 1e-12 * np.max(np.abs(diagonal), initial=0.0))
    size = np.sqrt(np.maximum(diagonal, least))
    scale = np.divide(1.0, size, out=np.ones_like(size), where=size > 0.0)
    return (matrix + matrix.T) / 2.0 * np.outer(scale, scale), size


def _rigid_motion(element: SuperElement) -> Check:
    rows, wanted = present_motions(element.motions, transfer(element.positions))
    figure = _ratio(np.linalg.norm(rows @ element.rigid_body_modes() - wanted), np.linalg.norm(wanted))
    cause = "the nodes cannot move as one rigid body: check node positions, output frames and length units"
    return Check("nodes follow a rigid motion", figure, RIGID, cause)


def _free(element: SuperElement) -> Check:
    phi = element.rigid_body_modes()
    force, size = np.linalg.norm(element.stiffness @ phi, axis=0), np.linalg.norm(phi, axis=0)
    stiffness = max(np.linalg.norm(element.stiffness), SOFT * np.linalg.norm(element.mass))
    figure = float(max(map(_ratio, force, stiffness * size), default=0.0))
    cause = (
        "rigid motion costs energy: rows in another order, output frames, wrong length unit or a missing node; "
        "if the part is held to the ground, say 'grounded: true'"
    )
    return Check("rigid motion is free, |K phi| / |K| |phi|", figure, RIGID, cause)


def _held(element: SuperElement) -> Check:
    scaled, size = _with_unit_diagonal(element.stiffness, np.zeros(element.size))
    motions = np.linalg.qr(element.rigid_body_modes() * size[:, None])[0]
    free = int(np.count_nonzero(np.linalg.eigvalsh(motions.T @ scaled @ motions) < HELD))
    cause = (
        f"'grounded: true' is said, but {free} of 6 rigid motions cost no energy: "
        "clamp a node set that holds the part, or leave 'grounded' out"
    )
    return Check("rigid motion is held", free, 0, cause)


def _equal_masses(element: SuperElement) -> Check:
    phi = element.rigid_body_modes()[:, :3]
    masses = phi.T @ element.mass @ phi
    mean = float(np.trace(masses)) / 3.0
    figure = _ratio(np.linalg.norm(masses - mean * np.eye(3)), abs(mean))
    cause = "the part weighs differently along x, y and z: rows in another order, or a node's mass is missing"
    return Check("three equal translational masses", figure, BODY, cause)


def _mass_of_a_body(element: SuperElement) -> Check:
    """phi^T M phi = [[m, -m [c]x], [m [c]x, J]]: [c]x is skew, and no moment of inertia exceeds the other two's sum."""
    phi = element.rigid_body_modes()
    rigid = phi.T @ element.mass @ phi
    mass, coupling = float(rigid[0, 0]), rigid[3:, :3]
    reach = max(np.linalg.norm(element.positions, axis=1).max(initial=0.0), 1e-3)
    inertia = float(np.trace(rigid[3:, 3:])) + mass * reach**2
    skew = _ratio(np.linalg.norm(coupling + coupling.T), np.sqrt(max(0.0, mass * inertia)))
    excess = _ratio(excess_moment(mass_properties(rigid).inertia), inertia)
    cause = "no body has such a mass: rows in another order, a missing node, or wrong output frames"
    return Check("rigid mass is that of a body", max(skew, excess), BODY, cause)


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
