"""A small part made by hand, for writing and reading back."""

from __future__ import annotations

import numpy as np

from ..finite_elements.rigid_motion import transfer
from ..reduction import SuperElement
from ..reduction.super_element import node_labels

NODES = {"11": (0.0, 0.0, 0.0), "23": (0.3, 0.1, -0.05)}  # m
MASSES, INERTIA = (2.0, 1.5), (4e-3, 5e-3, 6e-3)  # kg, kg m^2
STIFFNESS = (2e8, 3e8, 5e7, 1e6, 2e6, 3e6)  # N/m, N m/rad: of the second node relative to the first
FREQUENCIES = (420.0, 733.0)  # Hz


def plain_element() -> SuperElement:
    """Two nodes with lumped masses and a spring between them, and two fixed-interface modes that both nodes excite."""
    positions = np.array(list(NODES.values()))
    arm = transfer(positions)
    relative = np.hstack([-arm[1] @ np.linalg.inv(arm[0]), np.eye(6)])
    stiffness, mass = np.zeros((14, 14)), np.eye(14)
    stiffness[:12, :12] = relative.T @ np.diag(STIFFNESS) @ relative
    stiffness[12:, 12:] = np.diag((2.0 * np.pi * np.array(FREQUENCIES)) ** 2)
    mass[:12, :12] = np.diag([entry for lump in MASSES for entry in (*[lump] * 3, *INERTIA)])
    mass[:12, 12:] = 0.02 * np.cos(np.arange(24.0)).reshape(12, 2)
    mass[12:, :12] = mass[:12, 12:].T
    return SuperElement(
        stiffness=stiffness,
        mass=mass,
        nodes=tuple(NODES),
        positions=positions,
        motions=np.eye(14)[:12].reshape(2, 6, 14),
        n_modes=2,
        labels=(*node_labels("11"), *node_labels("23"), "mode 1", "mode 2"),
        provenance={"name": "plain", "modes": "fixed-interface"},
    )
