"""Poses solved one by one, all modes that are wanted of the whole system: what interpolation is not sure of."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING

import numpy as np

from ..arrays import FloatArray, IntArray
from .exact import CHUNK, Solved, Solver, part
from .in_frame import carried, is_possible, quantities_in_frame
from .interpolated.frames import Frame, in_frame
from .quantities import DENSE, Block, Labels, blank
from .reasons import reason_codes
from .request import Request
from .rounding import rounding
from .truth import FOLLOWED, at_pose, check_count, with_mass

if TYPE_CHECKING:
    from ..kinematics import Configurations
    from ..machine import Machine


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
    there = np.flatnonzero(block["reason"] == 0)
    if is_possible(request, machine.description.file.damping):
        solver = Solver(machine, _count(machine, request, frame), shift)
        pieces = _in_chunks(solver, request, found, there, frame)
    else:
        pieces = ((there[i : i + 1], at_pose(machine, found[int(k)], request)) for i, k in enumerate(there))
    for some, piece in pieces:
        for name, values in piece.items():
            if name not in block:
                block[name] = np.full((len(poses), *values.shape[1:]), np.nan)
            block[name][some] = values
    block["proof"][there] = DENSE
    return block


def _in_chunks(
    solver: Solver, request: Request, found: Configurations, there: IntArray, frame: Frame | None
) -> Iterator[tuple[IntArray, Block]]:
    for start in range(0, len(there), CHUNK):
        some = there[start : start + CHUNK]
        yield some, _chunk(solver, request, part(found, some), frame)


def _count(machine: Machine, request: Request, frame: Frame | None) -> int:
    """All modes for peaks, which every mode has a part in; else those asked for, and some between which to follow."""
    if frame is not None:
        return frame.size
    size = sum(each.size for each in machine.parts.values())
    return size if "frf_peak" in request.quantities else request.n_modes + FOLLOWED * ("identity" in request.quantities)


def _chunk(solver: Solver, request: Request, configurations: Configurations, frame: Frame | None) -> Block:
    solved = solver.solve(configurations)
    values, shapes = solved.modes.eigenvalues, solved.modes.shapes
    check_count(request, values.shape[1])
    held = carried(solved.systems, shapes, request)
    own = np.broadcast_to(np.eye(values.shape[1]), (len(values), values.shape[1], values.shape[1]))
    block = quantities_in_frame(values, own, held, request, solver.machine.description.file.damping)
    mass, stiffness = (np.diagonal(each, axis1=1, axis2=2) for each in (solved.systems.mass, solved.systems.stiffness))
    block["bound"] = rounding(values, shapes, mass, stiffness, held["rate"])[:, : request.n_modes]
    if "vectors" in block:
        block["vectors"] = with_mass(solved.systems.mass, shapes) if frame is None else _seen_in(frame, solved)
    return block


def _seen_in(frame: Frame, solved: Solved) -> FloatArray:
    """W^T M U (m, p, p): the modes in the smooth frame."""
    frames = in_frame(frame, solved.systems, solved.modes).frames
    return np.asarray(frames.swapaxes(1, 2) @ (solved.systems.mass @ solved.modes.shapes))
