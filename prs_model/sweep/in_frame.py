"""The quantities of a sweep from modes in a frame: the twin of `truth` for very many poses.

A frame W (n, p) spans the lowest p modes at a pose, orthonormal in M. A mode is W y with y (p,), so that every
quadratic form of modes (energies, receptance) comes from a p x p matrix of the frame. These matrices are smooth in the
pose even where modes cross: they are computed at nodes, by `carried`, and interpolated.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError
from ..linear_algebra import positive_definite_pencil, slowest_rate
from ..response.damping import is_proportional, modal_rates, modal_ratios
from ..response.static import solved_scaled
from .peaks import largest, places
from .quantities import Block
from .request import Request
from .rounding import is_rigid

if TYPE_CHECKING:
    from ..description.schema import Damping
    from ..synthesis.batch import Systems

_CHUNK = 256  # poses whose responses are searched at once, to bound memory


def is_possible(request: Request, damping: Damping) -> bool:
    """Whether modes in a frame give what is asked; peaks under joint damping, which couples modes, they do not."""
    return "frf_peak" not in request.quantities or is_proportional(damping)


def reaches(request: Request, lowest_left_out: float) -> bool:
    """Whether modes left out of the frame, the lowest at so many Hz, are far enough above the band for the peaks.

    What they add is a series in (f / f_left_out)^2 of which four terms are kept: up to 0.7 within 6 % of itself, which
    is a small share of a peak.
    """
    return "frf_peak" not in request.quantities or request.band is None or request.band[1] < 0.7 * lowest_left_out


def carried(systems: Systems, frame: FloatArray, request: Request) -> dict[str, FloatArray]:
    """What has to be known at each of N configurations beside the modes, for frames (N, n, p); all smooth in the pose.

    output (N, 6, p), compliance (N, 6, 6), residual (N, 4, 3), kinetic (N, bodies, t) and strain (N, members, t) with
    the t = p (p + 1) / 2 entries above and on the diagonal, rate (N,). NaN where a machine has no compliance.
    """
    wanted, found = set(request.quantities), {"rate": _rates(systems)}
    if wanted & {"flexibility_share", "frf_peak"}:
        found["output"] = systems.output @ frame
    if wanted & {"static_compliance", "flexibility_share", "frf_peak"}:
        found["compliance"], found["residual"] = _at_rest(systems, frame)
    if "kinetic_energy" in wanted:
        found["kinetic"] = _stacked(_reduced(systems, frame, name, "mass") for name in systems.blocks)
    if "strain_energy" in wanted:
        bodies = [_reduced(systems, frame, name, "stiffness") for name in systems.blocks]
        found["strain"] = _stacked([*bodies, *_joints(systems, frame)])
    return found


def quantities_in_frame(
    eigenvalues: FloatArray, vectors: FloatArray, held: dict[str, FloatArray], request: Request, damping: Damping
) -> Block:
    """A block from all modes of a frame: eigenvalues (m, p) [rad^2/s^2] ascending, vectors (m, p, p) in columns.

    held: what `carried` says, at these poses. Reason, proof and bound are not in it. Raises PrsError for peaks where
    `is_possible` says no.
    """
    k, wanted = request.n_modes, request.quantities
    rigid = is_rigid(eigenvalues, held["rate"])
    frequencies = np.sqrt(np.where(rigid, 0.0, eigenvalues)) / (2.0 * np.pi)
    block: Block = {"frequency": frequencies[:, :k]}
    if "static_compliance" in wanted:
        block["static_compliance"] = held["compliance"]
    if "flexibility_share" in wanted:
        block["flexibility_share"] = _flexibility_shares(eigenvalues[:, :k], vectors[:, :, :k], held)
    if "kinetic_energy" in wanted:
        block["kinetic_energy"] = _shares(held["kinetic"], vectors[:, :, :k])
    if "strain_energy" in wanted:
        shares = _shares(held["strain"], vectors[:, :, :k])
        block["strain_energy"] = np.where(rigid[:, :k, None], 0.0, shares)
    if "frf_peak" in wanted:
        block["frf_peak"], block["frf_peak_frequency"] = _peaks(eigenvalues, vectors, held, request, damping)
    if "identity" in wanted:
        block["vectors"], block["frame_frequency"] = vectors, frequencies
    return block


def _rates(systems: Systems) -> FloatArray:
    return np.array([slowest_rate(m, k) for m, k in zip(systems.mass, systems.stiffness, strict=True)])


def _at_rest(systems: Systems, frame: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Compliance (N, 6, 6) of the end-reference point, and what modes outside the frame add along u, v, w (N, 4, 3).

    R (K^-1 M)^j K^-1 (1 - M W W^T) R^T, j = 0 .. 3, the moments in omega^2 of the receptance of modes left out.
    """
    count = len(systems.mass)
    compliance, residual = np.full((count, 6, 6), np.nan), np.full((count, 4, 3), np.nan)
    for i, (mass, stiffness, free) in enumerate(systems.pencils):
        if positive_definite_pencil(mass, stiffness)[0] != 0.0:
            continue
        loads = free.T @ systems.output[i].T
        inside = free.T @ (systems.mass[i] @ frame[i])
        purged = loads[:, :3] - inside @ (frame[i].T @ systems.output[i, :3].T)
        solved = solved_scaled(stiffness, np.hstack([loads, purged]))
        first = solved[:, 6:]
        second = solved_scaled(stiffness, mass @ first)
        compliance[i] = loads.T @ solved[:, :6]
        pairs = ((loads[:, :3], first), (first, mass @ first), (first, mass @ second), (second, mass @ second))
        residual[i] = [np.einsum("ni,ni->i", a, b) for a, b in pairs]
    return compliance, residual


def _reduced(systems: Systems, frame: FloatArray, body: str, matrix: str) -> FloatArray:
    """W_b^T A_b W_b (N, p, p) of a body's mass or stiffness."""
    part = frame[:, systems.blocks[body]]
    return np.asarray(part.swapaxes(1, 2) @ getattr(systems.elements[body], matrix) @ part)


def _joints(systems: Systems, frame: FloatArray) -> list[FloatArray]:
    """The strain of each joint, its springs together (N, p, p)."""
    joints: dict[str, FloatArray] = {}
    for spring in systems.springs:
        strain = spring.displacement @ frame[:, spring.rows]
        energy = strain.swapaxes(1, 2) @ spring.stiffness @ strain
        joints[spring.joint] = joints.get(spring.joint, 0.0) + energy
    return list(joints.values())


def _stacked(matrices: Iterator[FloatArray] | list[FloatArray]) -> FloatArray:
    """Entries above and on the diagonal (N, b, t) of b symmetric matrices (N, p, p)."""
    every = np.stack(list(matrices), axis=1)
    rows, columns = np.triu_indices(every.shape[-1])
    return np.asarray(every[:, :, rows, columns])


def _shares(entries: FloatArray, vectors: FloatArray) -> FloatArray:
    """y^T A_b y over their sum (m, k, b), of entries (m, b, t) and vectors (m, p, k)."""
    rows, columns = np.triu_indices(vectors.shape[1])
    products = np.where(rows == columns, 1.0, 2.0)[:, None] * vectors[:, rows] * vectors[:, columns]
    energies = (entries @ products).swapaxes(1, 2)
    total = energies.sum(axis=2, keepdims=True)
    return np.where(total > 0.0, energies / np.where(total > 0.0, total, 1.0), 0.0)


def _flexibility_shares(eigenvalues: FloatArray, vectors: FloatArray, held: dict[str, FloatArray]) -> FloatArray:
    """phi^2 / lambda over the compliance (m, k, 6), eq. (21); 0 where that is 0."""
    total = np.diagonal(held["compliance"], axis1=1, axis2=2)[:, :, None]
    shares = (held["output"] @ vectors) ** 2 / eigenvalues[:, None] / np.where(total > 0.0, total, np.nan)
    return np.asarray(np.where(total <= 0.0, 0.0, shares).swapaxes(1, 2))


def _peaks(
    eigenvalues: FloatArray, vectors: FloatArray, held: dict[str, FloatArray], request: Request, damping: Damping
) -> tuple[FloatArray, FloatArray]:
    """Largest receptances (m, 3) along u, v, w and their frequencies (m, 3) [Hz]: modes of the frame, and the rest.

    The rest is taken without damping, which leaves about 0.1 % of a peak at a ratio of 0.025.
    """
    if request.band is None or not is_possible(request, damping):
        raise PrsError("frf_peak: joints that damp couple the modes; expected modal ratios or Rayleigh damping")
    count = len(eigenvalues)
    peaks, at = np.empty((count, 3)), np.empty((count, 3))
    moving = np.maximum(eigenvalues, np.finfo(float).tiny)
    rates = _rates_of_decay(damping, moving)
    squares = (held["output"][:, :3] @ vectors) ** 2
    for start in range(0, count, _CHUNK):
        some = slice(start, start + _CHUNK)
        omega = np.sqrt(moving[some])
        where = places(omega, 0.5 * rates[some] / omega, request.band)
        response = _Response(moving[some], rates[some], squares[some], held["residual"][some])
        peaks[some], at[some] = largest(response, where)
    return peaks, at / (2.0 * np.pi)


def _rates_of_decay(damping: Damping, eigenvalues: FloatArray) -> FloatArray:
    """2 xi omega, or alpha + beta omega^2 (m, p) [1/s]."""
    if damping.rayleigh is not None or not len(eigenvalues):
        return modal_rates(damping, eigenvalues)
    return np.asarray(2.0 * modal_ratios(damping, eigenvalues[0]) * np.sqrt(eigenvalues))


class _Response:
    """|h| along u, v, w at omega (m, f), of modes (m, p) with squares of their motions (m, 3, p), and residuals."""

    def __init__(self, eigenvalues: FloatArray, rates: FloatArray, squares: FloatArray, residual: FloatArray):
        self.eigenvalues, self.rates, self.squares, self.residual = eigenvalues, rates, squares, residual

    def __call__(self, omega: FloatArray) -> FloatArray:
        each = omega[:, :, None]
        dynamic = self.eigenvalues[:, None] - each**2 + 1j * each * self.rates[:, None]
        rest = (each**2) ** np.arange(4) @ self.residual
        return np.abs((1.0 / dynamic) @ self.squares.swapaxes(1, 2) + rest)
