"""Where the energy of a mode sits (eq. 22): in bodies, joints, limbs, and directions of joints.

All shares are of the mode's total, kinetic or strain, and sum to one over the machine. A mode at zero frequency strains
nothing: its strain shares are zero.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray

if TYPE_CHECKING:
    from ..synthesis import System
    from .modes import Modes

Energies = dict[str, FloatArray]
"""By name, (k,) or (6, k)."""


def kinetic_energy(modes: Modes) -> Energies:
    """phi_b^T M_b phi_b over their sum, (k,) for each body."""
    elements = modes.system.elements
    return _shares({name: _quadratic(modes.body_shapes(name), element.mass) for name, element in elements.items()})


def strain_energy(modes: Modes) -> Energies:
    """`strain_shares` of each mode.

    With lambda, the share of a joint is the eigenvalue's derivative with respect to its stiffness factor (where the
    coordinates do not follow the joints).
    """
    return strain_shares(modes.system, _elastic(modes))


def strain_shares(system: System, shapes: FloatArray) -> Energies:
    """u_b^T K_b u_b for each body and d^T K_s d for each joint, over their sum, (k,), of any motions u (n, k).

    A joint of the same name as a body is called ``joint ..``.
    """
    joints = {name: each.sum(axis=0) for name, each in _in_joints(system, shapes).items()}
    return _shares({**_in_bodies(system, shapes), **joints})


def joint_strain_by_direction(modes: Modes) -> Energies:
    """d_i (K_s d)_i for each joint, over the mode's strain energy, (6, k), by axes of the joint's frame.

    It is the work of each component of the wrench; a joint's six sum to its share. Where the stiffness is diagonal
    each is the energy of that direction, exactly; where directions are coupled (a full matrix, a chain of stages seen
    in the frame of the first) one may be negative.
    """
    system, shapes = modes.system, _elastic(modes)
    joints = _in_joints(system, shapes)
    whole = sum(_in_bodies(system, shapes).values()) + sum(each.sum(axis=0) for each in joints.values())
    return {name: _over(each, np.asarray(whole)) for name, each in joints.items()}


def by_limb(shares: Mapping[str, FloatArray], limbs: Mapping[str, str]) -> Energies:
    """Shares (k,) of bodies and joints added up over limbs; what belongs to none keeps its name."""
    gathered: Energies = {}
    for name, share in shares.items():
        limb = limbs.get(name.removeprefix(_JOINT), name)
        gathered[limb] = gathered.get(limb, 0.0) + share
    return gathered


_JOINT = "joint "


def _elastic(modes: Modes) -> FloatArray:
    """The shapes, zero where they are rigid motions."""
    return np.where(modes.is_rigid, 0.0, modes.shapes)


def _in_bodies(system: System, shapes: FloatArray) -> Energies:
    return {
        name: _quadratic(system.expansion[system.blocks[name]] @ shapes, element.stiffness)
        for name, element in system.elements.items()
    }


def _in_joints(system: System, shapes: FloatArray) -> Energies:
    """Twice the strain energy (6, k) by directions of the joint's frame, its springs together."""
    energy: Energies = {}
    for spring in system.springs:
        name = f"{_JOINT}{spring.joint}" if spring.joint in system.elements else spring.joint
        strain = spring.displacement @ (system.expansion[spring.rows] @ shapes)
        energy[name] = energy.get(name, 0.0) + strain * (spring.stiffness @ strain)
    return energy


def _quadratic(shapes: FloatArray, matrix: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("ik,ij,jk->k", shapes, matrix, shapes, optimize=True))


def _shares(energy: Mapping[str, FloatArray]) -> Energies:
    total = np.asarray(sum(energy.values()))
    return {name: _over(part, total) for name, part in energy.items()}


def _over(part: FloatArray, total: FloatArray) -> FloatArray:
    positive = total > 0.0
    return np.where(positive, part / np.where(positive, total, 1.0), 0.0)
