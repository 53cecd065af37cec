"""How a sweep is worked out: by an interpolation that pays, by one basis for all poses, or pose by pose."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from typing import TYPE_CHECKING

import numpy as np

from ..errors import PrsError
from ..linear_algebra import positive_definite_pencil
from .compiled import best
from .enclosed.basis_at_poses import ritz_at_poses
from .enclosed.ritz_at_poses import RitzAtPoses
from .exact import Solver
from .in_frame import is_possible, reaches
from .interpolated.following import EXTRA
from .interpolated.interpolation import Interpolation
from .interpolated.planner import interpolated
from .poses import Poses
from .request import Request

if TYPE_CHECKING:
    from ..machine import Machine

Found = Interpolation | RitzAtPoses

_DOES_NOT_SERVE = (PrsError, np.linalg.LinAlgError)  # solving pose by pose will tell what is really wrong

_FEWEST = 400  # poses that are worth an interpolation
_WORTH_BASIS = 2000  # poses that are worth a basis for all of them
_PAYS, _PAYS_BESIDE_A_BASIS, _PAYS_ON_A_LIST = 2.0, 4.0, 20.0  # poses for each node of an interpolation, at least


def planned(machine: Machine, poses: Poses, request: Request, pool: ThreadPoolExecutor) -> tuple[Found | None, str]:
    """What gives frequencies within the tolerance at nearly every pose, or none; and in words why.

    An interpolation where no more than three coordinates vary and its nodes are few beside the poses; else a basis for
    all poses, if they are worth one and nothing but frequencies is asked for; else none, and all are solved in full.
    """
    if poses.size < _FEWEST:
        return None, f"{poses.size} poses are solved one by one"
    if not is_possible(request, machine.description.file.damping):
        return None, "resonance peaks under damping of joints"
    solver, pays = _solver(machine, request), _PAYS
    if _worth_a_basis(poses, request):
        pays = _PAYS_BESIDE_A_BASIS if poses.is_grid else _PAYS_ON_A_LIST
    try:
        return interpolated(machine, poses, request, solver, pool, poses.size / pays)
    except _DOES_NOT_SERVE as error:
        why = f"no interpolation: {error}"
    if not _worth_a_basis(poses, request):
        return None, why
    try:
        found, words = ritz_at_poses(request, solver, poses, pool, best("enclosed.kernels_ritz"))
        return found, f"{words}; {why}"
    except _DOES_NOT_SERVE as error:
        return None, f"{why}; {error}"


def _solver(machine: Machine, request: Request) -> Solver:
    """For enough modes to find a gap above those asked for, and above those that resonate in the band."""
    reference = machine.assemble(machine.configuration(**machine.reference_pose))
    shift, _ = positive_definite_pencil(reference.mass, reference.stiffness)
    if request.band is None:
        return Solver(machine, request.n_modes + EXTRA, shift)
    frequencies = reference.modes(reference.size).frequencies
    resonant = next((k for k, each in enumerate(frequencies) if reaches(request, each)), reference.size)
    return Solver(machine, max(request.n_modes, resonant) + EXTRA, shift)


def _worth_a_basis(poses: Poses, request: Request) -> bool:
    return request.quantities == ("frequency",) and poses.size >= _WORTH_BASIS
