"""Lowest modes of parts joined by springs: block inverse iteration, the springs brought in by the Woodbury identity.

A = K - s M of the joined machine is A_0 + D^T S D: A_0 the parts' own, factorized once; S the springs on the motions
U = D u of the interface nodes. Rigid joints leave U = E z. Then A u = b has u = A_0^-1 b - Y f with Y = A_0^-1 D^T,
H = D Y, and forces f from [[H, E], [E^T, -S_z]] [f; z] = [D A_0^-1 b; 0] (W. W. Hager, Updating the inverse of a
matrix, SIAM Review 31, 1989).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np
from scipy.linalg import block_diag, eigh, lu_factor, lu_solve

from ..arrays import FloatArray
from ..errors import PrsError
from .part import CompletePart

MORE = 6  # vectors iterated beyond those asked for
MOST_ITERATIONS = 20
ACCURACY = 1e-5  # of a mode, so that its frequency is good to about the square


@dataclass(frozen=True, eq=False)
class Joined:
    """Parts (one CompletePart may stand for several bodies) and what joins them in one configuration.

    bodies: the part of each body, in the order of all coordinates. springs: S_z (m, m) on the coordinates z of
    `expansion`, E (6 k, m), for the k nodes of all bodies. shift: s [rad^2/s^2] of the parts' factorizations.
    """

    bodies: Mapping[str, CompletePart]
    springs: FloatArray
    expansion: FloatArray
    shift: float

    @property
    def size(self) -> int:
        """Number of DOFs."""
        return sum(part.size for part in self.bodies.values())

    @cached_property
    def blocks(self) -> dict[str, slice]:
        """The rows of each body."""
        stops = np.cumsum([part.size for part in self.bodies.values()])
        return {
            name: slice(int(stop) - part.size, int(stop))
            for (name, part), stop in zip(self.bodies.items(), stops, strict=True)
        }

    @cached_property
    def node_blocks(self) -> dict[str, slice]:
        """The rows of each body's nodes among those of U."""
        widths = [part.responses.shape[1] for part in self.bodies.values()]
        edges = pairwise(np.cumsum([0, *widths]).tolist())
        return {name: slice(*edge) for name, edge in zip(self.bodies, edges, strict=True)}

    def node_motions(self, shapes: FloatArray) -> FloatArray:
        """U = D u (6 k, c) of shapes (n, c)."""
        return np.vstack([part.outputs @ shapes[self.blocks[name]] for name, part in self.bodies.items()])


@dataclass(frozen=True, eq=False)
class Solution:
    """eigenvalues (c,) [rad^2/s^2], vectors (n, c) mass-normalised, residuals (c,) in the norm of M, relative."""

    eigenvalues: FloatArray
    vectors: FloatArray
    residuals: FloatArray
    iterations: int


def lowest(joined: Joined, count: int) -> Solution:
    """The `count` lowest modes. Raises PrsError when the iteration does not come to rest.

    A residual r = |theta A^-1 M x - x|, in the norm of M, of a Ritz pair (theta, x) of A and M says that an eigenvalue
    lies within r of theta, relative, and about r^2 where no other is as near.
    """
    solve = _Inverse(joined)
    values, shapes = _first_guess(joined, count + MORE)
    for iteration in range(1, MOST_ITERATIONS + 1):
        errors = solve(_times_mass(joined, shapes)) * values - shapes
        residuals = np.sqrt(np.einsum("ij,ij->j", errors, _times_mass(joined, errors)))
        if np.all(residuals[:count] <= ACCURACY):
            return Solution(values[:count] + joined.shift, shapes[:, :count], residuals[:count], iteration)
        moving = residuals > ACCURACY
        basis = np.hstack([shapes, errors[:, moving] / residuals[moving]])
        values, shapes = _ritz(joined, _obeying(joined, basis), len(values))
    raise PrsError(f"the complete-order modes did not come to rest in {MOST_ITERATIONS} iterations")


class _Inverse:
    """b (n, c) -> A^-1 b, bodies of one part solved together."""

    def __init__(self, joined: Joined):
        self.joined = joined
        flexibility = block_diag(*(part.flexibility for part in joined.bodies.values()))
        force = 1.0 / np.sqrt(np.diag(flexibility))
        motion = 1.0 / np.linalg.norm(force[:, None] * joined.expansion, axis=0)
        scale = np.concatenate([force, motion])  # without it forces of newtons meet motions of nanometres
        saddle = np.block([[flexibility, joined.expansion], [joined.expansion.T, -joined.springs]])
        self.scale, self.saddle = scale[:, None], lu_factor(saddle * np.outer(scale, scale))

    def __call__(self, loads: FloatArray) -> FloatArray:
        shapes, blocks = np.empty_like(loads), self.joined.blocks
        for part, names in _by_part(self.joined.bodies):
            stacked = np.hstack([loads[blocks[name]] for name in names])
            for name, each in zip(names, np.split(part.solve(stacked), len(names), axis=1), strict=True):
                shapes[blocks[name]] = each
        motions = self.joined.node_motions(shapes)
        right = np.vstack([motions, np.zeros((len(self.scale) - len(motions), loads.shape[1]))])
        forces = (self.scale * lu_solve(self.saddle, self.scale * right))[: len(motions)]
        for name, part in self.joined.bodies.items():
            shapes[blocks[name]] -= part.responses @ forces[self.joined.node_blocks[name]]
        return shapes


def _first_guess(joined: Joined, count: int) -> tuple[FloatArray, FloatArray]:
    """Ritz pairs of A and M among the parts' static shapes u = Y H^-1 E z, on which A is E^T H^-1 E + S_z."""
    parts = joined.bodies.values()
    nodes = [joined.expansion[rows] for rows in joined.node_blocks.values()]
    loads = [np.linalg.solve(part.flexibility, e) for part, e in zip(parts, nodes, strict=True)]
    stiffness, mass = joined.springs.copy(), np.zeros_like(joined.springs)
    for part, e, load in zip(parts, nodes, loads, strict=True):
        stiffness += e.T @ load
        mass += load.T @ part.inertia @ load
    count = min(count, len(stiffness))
    inverse, ritz = eigh(_symmetric(mass), _symmetric(stiffness), subset_by_index=[len(mass) - count, len(mass) - 1])
    ritz = ritz[:, ::-1] / np.sqrt(inverse[::-1])
    shapes = np.empty((joined.size, count))
    for (name, part), load in zip(joined.bodies.items(), loads, strict=True):
        shapes[joined.blocks[name]] = part.responses @ (load @ ritz)
    return 1.0 / inverse[::-1], shapes


def _ritz(joined: Joined, basis: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """The `count` lowest Ritz pairs of A and M in a basis (n, c) that obeys rigid joints; vectors mass-normalised."""
    mass, stiffness = np.zeros((2, basis.shape[1], basis.shape[1]))
    for name, part in joined.bodies.items():
        own = basis[joined.blocks[name]]
        mass += own.T @ (part.model.mass @ own)
        stiffness += own.T @ (part.model.stiffness @ own)
    independent = np.linalg.lstsq(joined.expansion, joined.node_motions(basis), rcond=None)[0]
    stiffness += independent.T @ joined.springs @ independent - joined.shift * mass
    first = len(mass) - count
    inverse, ritz = eigh(_symmetric(mass), _symmetric(stiffness), subset_by_index=[first, len(mass) - 1])
    inverse, ritz = inverse[::-1], ritz[:, ::-1]
    return 1.0 / inverse, basis @ (ritz / np.sqrt(inverse))


def _obeying(joined: Joined, basis: FloatArray) -> FloatArray:
    """The basis without what round-off has put across the rigid joints, which a Ritz step would make use of."""
    if joined.expansion.shape[0] == joined.expansion.shape[1]:
        return basis
    motions = joined.node_motions(basis)
    gap = motions - joined.expansion @ np.linalg.lstsq(joined.expansion, motions, rcond=None)[0]
    for name, part in joined.bodies.items():
        forces = np.linalg.solve(part.flexibility, gap[joined.node_blocks[name]])
        basis[joined.blocks[name]] -= part.responses @ forces
    return basis


def _times_mass(joined: Joined, shapes: FloatArray) -> FloatArray:
    product = np.empty_like(shapes)
    for name, part in joined.bodies.items():
        product[joined.blocks[name]] = part.model.mass @ shapes[joined.blocks[name]]
    return product


def _by_part(bodies: Mapping[str, CompletePart]) -> list[tuple[CompletePart, list[str]]]:
    """Each part with the bodies that it stands for."""
    names: dict[int, list[str]] = {}
    for name, part in bodies.items():
        names.setdefault(id(part), []).append(name)
    return [(bodies[group[0]], group) for group in names.values()]


def _symmetric(matrix: FloatArray) -> FloatArray:
    return np.asarray((matrix + matrix.T) / 2.0)
