"""Poses solved one by one, all modes that are wanted of the whole system: what interpolation is not sure of."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray
from .exact import CHUNK, Solved, Solver, part
from .frames import Frame, in_frame
from .in_frame import carried, quantities_in_frame
from .quantities import Block, Labels, blank
from .reasons import reason_codes
from .request import Request
from .truth import check_count

if TYPE_CHECKING:
    from ..kinematics import Configurations
    from ..machine import Machine
    from ..synthesis.batch import Systems

DENSE = 2  # code of `proof`
ROUNDING = 1e-12  # relative, of eigenvalues by LAPACK
_FOLLOWED = 4  # modes above those asked for, between which identities are followed


def solved_directly(
    machine: Machine, request: Request, poses: FloatArray, labelled: Labels, shift: float, frame: Frame | None = None
) -> Block:
    """The block of poses (m, d) [m, rad], unreachable ones marked.

    frame: in which the vectors are told, to compare with interpolated ones; else they are M^(1/2) times the shapes.
    Raises PrsError where a machine has fewer modes than are asked for, or is singular.
    """
    found = machine.kinematics.solve_batch(poses)
    block = blank(request, labelled, len(poses))
    block["reason"] = reason_codes(machine.kinematics.reach, found.q)
    solver = Solver(machine, _count(machine, request, frame), shift)
    there = np.flatnonzero(block["reason"] == 0)
    for start in range(0, len(there), CHUNK):
        some = there[start : start + CHUNK]
        for name, values in _chunk(solver, request, part(found, some), frame).items():
            if name not in block:
                block[name] = np.full((len(poses), *values.shape[1:]), np.nan)
            block[name][some] = values
    block["proof"][there], block["bound"][there] = DENSE, ROUNDING
    return block


def _count(machine: Machine, request: Request, frame: Frame | None) -> int:
    """All modes for peaks, which every mode has a part in; else those asked for, and some between which to follow."""
    if frame is not None:
        return frame.size
    size = sum(each.size for each in machine.parts.values())
    return (
        size if "frf_peak" in request.quantities else request.n_modes + _FOLLOWED * ("identity" in request.quantities)
    )


def _chunk(solver: Solver, request: Request, configurations: Configurations, frame: Frame | None) -> Block:
    solved = solver.solve(configurations)
    values, shapes = solved.modes.eigenvalues, solved.modes.shapes
    check_count(request, values.shape[1])
    held = carried(solved.systems, shapes, request)
    own = np.broadcast_to(np.eye(values.shape[1]), (len(values), values.shape[1], values.shape[1]))
    block = quantities_in_frame(values, own, held, request, solver.machine.description.file.damping)
    if "vectors" in block:
        block["vectors"] = _with_mass(solved.systems, shapes) if frame is None else _seen_in(frame, solved)
    return block


def _seen_in(frame: Frame, solved: Solved) -> FloatArray:
    """W^T M U (m, p, p): the modes in the smooth frame."""
    frames = in_frame(replace(frame, level=None), solved.systems, solved.modes).frames
    return np.asarray(frames.swapaxes(1, 2) @ (solved.systems.mass @ solved.modes.shapes))


def _with_mass(systems: Systems, shapes: FloatArray) -> FloatArray:
    """M^(1/2) times the shapes (m, n, k): orthonormal, and alike at poses near each other."""
    values, vectors = np.linalg.eigh(systems.mass)
    root = (vectors * np.sqrt(np.maximum(values, 0.0))[:, None]) @ vectors.swapaxes(1, 2)
    return np.asarray(root @ shapes)
