"""The truth at one pose, by the library's own analyses; every fast path is held against it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError
from ..linear_algebra import positive_definite_pencil, slowest_rate
from ..response.modal_equations import modal_equations
from .peaks import largest, places
from .quantities import DENSE, Block, Labels, blank, labels
from .request import Request
from .rounding import rounding

if TYPE_CHECKING:
    from ..kinematics import Configuration
    from ..machine import Machine
    from ..modes import Modes

FOLLOWED = 4
"""Modes above those asked for, between which identities are followed."""


def at_pose(machine: Machine, configuration: Configuration, request: Request) -> Block:
    """A block of one pose: what machine.assemble, System and Modes say there.

    What a machine that can move without straining anything does not have (compliance, its shares, peaks) is NaN.
    Raises PrsError where fewer modes exist than were asked for.
    """
    system = machine.assemble(configuration)
    with_peaks = "frf_peak" in request.quantities
    modes = system.modes(system.size if with_peaks else request.n_modes + FOLLOWED)
    check_count(request, len(modes.frequencies))
    labelled = labels(machine, request)
    block = blank(request, labelled, 1)
    block["frequency"][0] = modes.frequencies[: request.n_modes]
    block["bound"][0] = _bound(modes)[: request.n_modes]
    block["proof"][0] = DENSE
    _add_energies(block, modes, request, labelled)
    if positive_definite_pencil(system.mass, system.stiffness)[0] == 0.0:
        _add_compliances(block, modes, request)
    if "identity" in request.quantities:
        some = slice(request.n_modes + FOLLOWED)
        block["vectors"] = _with_mass(modes)[None, :, some]
        block["frame_frequency"] = modes.frequencies[None, some]
    return block


def check_count(request: Request, available: int) -> None:
    """Raises PrsError where a machine has fewer modes than a request asks for."""
    if request.n_modes > available:
        raise PrsError(f"n_modes: found {request.n_modes}, expected at most {available}: the machine has no more")


def check_damping(machine: Machine, request: Request) -> None:
    """Raises PrsError where peaks are asked for of a machine without any damping."""
    damping = machine.description.file.damping
    ratios = np.any(damping.modal) or damping.rayleigh is not None
    if "frf_peak" in request.quantities and not ratios and not damping.joints:
        raise PrsError(
            f"frf_peak: the description of '{machine.name}' has no damping, without which peaks are infinite; add an "
            "entry such as damping: {modal: 0.02}"
        )


def _add_energies(block: Block, modes: Modes, request: Request, labelled: Labels) -> None:
    for quantity, dim, shares in (
        ("kinetic_energy", "body", modes.kinetic_energy),
        ("strain_energy", "member", modes.strain_energy),
    ):
        if quantity in request.quantities:
            found = shares()
            block[quantity][0] = np.array([found[str(name)][: request.n_modes] for name in labelled[dim]]).T


def _add_compliances(block: Block, modes: Modes, request: Request) -> None:
    if "static_compliance" in request.quantities:
        block["static_compliance"][0] = modes.static_compliance()
    if "flexibility_share" in request.quantities:
        block["flexibility_share"][0] = modes.flexibility_shares()[: request.n_modes]
    if "frf_peak" in request.quantities:
        block["frf_peak"][0], block["frf_peak_frequency"][0] = _peaks(modes, request)


def _peaks(modes: Modes, request: Request) -> tuple[FloatArray, FloatArray]:
    """Largest receptance (3,) along u, v, w, and its frequency (3,) [Hz], all modes superposed."""
    equations = modal_equations(modes, modes.system.damping_model)
    omega = np.sqrt(equations.eigenvalues)
    moving = omega > 0.0
    rates = np.diag(equations.viscous)[moving] + np.diag(equations.loss)[moving] / omega[moving]
    assert request.band is not None  # Request sees to it
    where = np.unique(places(omega[None, moving], 0.5 * (rates / omega[moving])[None], request.band))[None]

    def magnitudes(at: FloatArray) -> FloatArray:
        response = modes.frf(at[0] / (2.0 * np.pi))
        return np.abs(response[None, :, range(3), range(3)])

    peaks, at = largest(magnitudes, where)
    return peaks[0], at[0] / (2.0 * np.pi)


def with_mass(mass: FloatArray, shapes: FloatArray) -> FloatArray:
    """M^(1/2) (.., n, n) times the shapes (.., n, k): orthonormal, and alike at poses near each other."""
    values, vectors = np.linalg.eigh(mass)
    root = (vectors * np.sqrt(np.maximum(values, 0.0))[..., None, :]) @ vectors.swapaxes(-1, -2)
    return np.asarray(root @ shapes)


def _with_mass(modes: Modes) -> FloatArray:
    """The same on all body coordinates (N, k), body by body."""
    elements = modes.system.elements
    return np.vstack([with_mass(each.mass, modes.body_shapes(name)) for name, each in elements.items()])


def _bound(modes: Modes) -> FloatArray:
    mass, stiffness = modes.system.mass, modes.system.stiffness
    rate = np.array(slowest_rate(mass, stiffness))
    return rounding(modes.eigenvalues, modes.shapes, np.diag(mass), np.diag(stiffness), rate)
