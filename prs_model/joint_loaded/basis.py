"""The shapes of a part under its joints.

The part (K, M) is held by springs K_s at its ends D_s u, whose other ends follow the bodies beyond. When these move
rigidly by xi, so that a spring's far end moves by X_s xi, the part takes the static shapes

    V = (K + sum D_s^T K_s D_s)^-1 sum D_s^T K_s X_s

six for each joint. All bodies beyond may move as one, so the part's own rigid motions are among them. Its modes are
the lowest ones with the far ends held. Rigid directions of a joint are constraints in place of springs.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import null_space, pinvh

from ..arrays import FloatArray
from ..linear_algebra import lowest_modes, slowest_rate
from ..reduction import SuperElement
from .grips import Grip

REPEATED = 1e-9  # of the largest energy: what remains of a shape that others make up
STILL = 1e-8  # of the slowest rate of a coordinate: the eigenvalue of a motion that the joints leave free
SINGULAR = 1e-11
STRAINED = 1e-8  # of a shape's energy in the norm of `energy_matrix`


@dataclass(frozen=True, eq=False)
class Held:
    """A part held by its joints, whose far ends stand still."""

    element: SuperElement
    grips: Sequence[Grip]

    @cached_property
    def stiffness(self) -> FloatArray:
        """(n, n): the part's and its springs'."""
        springs = [grip.end.T @ grip.law.stiffness @ grip.end for grip in self.grips]
        return np.asarray(self.element.stiffness + sum(springs))

    @cached_property
    def rows(self) -> FloatArray:
        """(r, n): what rigid joints hold."""
        none = np.zeros((0, self.element.size))
        return np.vstack([none, *(grip.law.rigid_wrenches.T @ grip.end for grip in self.grips)])

    @cached_property
    def free(self) -> FloatArray:
        """(n, m): the motions that rigid joints leave."""
        return np.asarray(null_space(self.rows)) if len(self.rows) else np.eye(self.element.size)

    def equilibrium(self, loads: FloatArray, motions: FloatArray) -> FloatArray:
        """Shapes (n, c) under loads (n, c), the far ends of rigid joints moved by motions (r, c)."""
        follow = np.linalg.lstsq(self.rows, motions, rcond=None)[0] if len(self.rows) else np.zeros_like(loads)
        return np.asarray(follow + self._flexibility @ (loads - self.stiffness @ follow))

    @cached_property
    def _flexibility(self) -> FloatArray:
        stiffness = self.free.T @ self.stiffness @ self.free
        diagonal = np.diag(stiffness)
        scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
        free = self.free * scale
        return np.asarray(free @ pinvh(stiffness * np.outer(scale, scale), rtol=SINGULAR) @ free.T)


def joint_loaded_basis(part: Held, n_modes: int) -> FloatArray:
    """(n, r): a part's static shapes, those for loads on nodes that no joint holds, and its lowest modes.

    The columns are orthonormal combinations of these in the norm of `energy_matrix`.
    """
    static = static_shapes(part, reach_of(part.element))
    energy = energy_matrix(part, static)
    others = np.hstack([_under_loads(part), _modes(part, n_modes)])
    largest = _energy_of(energy, static).max(initial=0.0) or 1.0
    columns = np.hstack([static, others * np.sqrt(largest / _energy_of(energy, others))])
    return columns @ independent(energy, columns)


def static_shapes(part: Held, reach: float) -> FloatArray:
    """(n, 6 p): a part's shapes when what lies beyond its joints moves rigidly, for each of p patterns of grips.

    Twists are about the body's origin, their rotations such that a point at the distance `reach` [m] moves as far as in
    the translations. What the joints do not pass on is zero.
    """
    twists = np.diag([1.0, 1.0, 1.0, 1.0 / reach, 1.0 / reach, 1.0 / reach])
    patterns = dict.fromkeys(grip.pattern for grip in part.grips)
    moved = [part.equilibrium(*_beyond(part, pattern, twists)) for pattern in patterns]
    return np.hstack([np.zeros((part.element.size, 0)), *moved])


def rigid_and_elastic(part: Held, static: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Combinations (6 p, r) of static shapes: the part's rigid motions, if it is free, and independent shapes besides.

    All that lies beyond a free part's joints moving as one moves it rigidly.
    """
    energy = energy_matrix(part, static)
    together = np.tile(np.eye(6), (static.shape[1] // 6, 1))
    moved = static @ together
    strained = _energy_of(part.element.stiffness, moved) > STRAINED * _energy_of(energy, moved)
    if part.element.grounded or np.any(strained):
        return together[:, :0], independent(energy, static)
    overlap = static.T @ energy @ static
    share = np.linalg.solve(together.T @ overlap @ together, together.T @ overlap)
    others = np.eye(static.shape[1]) - together @ share
    return together, others @ independent(energy, static @ others)


def reach_of(element: SuperElement) -> float:
    """How far [m] the farthest node stands from the body's origin."""
    return float(np.linalg.norm(element.positions, axis=1).max(initial=0.0)) or 1.0


def independent(energy: FloatArray, shapes: FloatArray) -> FloatArray:
    """(c, r): combinations of shapes (n, c) that are orthonormal in an energy (n, n); repeated ones are left out."""
    overlap = shapes.T @ energy @ shapes
    weight, combination = np.linalg.eigh((overlap + overlap.T) / 2.0)
    apart = weight > REPEATED * weight.max(initial=0.0)
    return np.asarray(combination[:, apart] / np.sqrt(weight[apart]))


def energy_matrix(part: Held, static: FloatArray) -> FloatArray:
    """K + g sum D_j^T D_j over the nodes (n, n), g as stiff as the joints are.

    In this norm a rigid motion is the smallest of all that have its node motions, since K holds no rigid motion: so
    coordinates orthonormal in it give the rigid-body modes of an element their meaning.
    """
    element = part.element
    size = float(np.linalg.norm(np.ptp(element.positions, axis=0))) or 1.0
    motions = element.motions * np.array([1.0, 1.0, 1.0, size, size, size])[:, None]
    nodes = np.einsum("jai,jab->ib", motions, motions, optimize=True)
    moved = float(np.sum(_energy_of(nodes, static)))
    stiffness = float(np.sum(_energy_of(part.stiffness, static))) / moved if moved > 0.0 else 0.0
    return np.asarray(element.stiffness + (stiffness or 1.0) * nodes)


def _beyond(part: Held, pattern: tuple[str, str | None], twists: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Loads (n, 6) of the springs and motions (r, 6) of the rigid rows when what lies beyond one pattern moves."""
    moved = [grip.counterpart @ twists * (grip.pattern == pattern) for grip in part.grips]
    pairs = list(zip(part.grips, moved, strict=True))
    loads = sum(grip.end.T @ grip.law.stiffness @ motion for grip, motion in pairs)
    return np.asarray(loads), np.vstack([grip.law.rigid_wrenches.T @ motion for grip, motion in pairs])


def _under_loads(part: Held) -> FloatArray:
    """(n, 6 l): shapes under unit loads on the nodes that no joint takes hold of."""
    touched = {node for grip in part.grips for node in grip.nodes}
    loads = [part.element.motions[node].T for node in range(len(part.element.nodes)) if node not in touched]
    if not loads:
        return np.zeros((part.element.size, 0))
    return part.equilibrium(np.hstack(loads), np.zeros((len(part.rows), 6 * len(loads))))


def _modes(part: Held, count: int) -> FloatArray:
    """(n, count and more): the lowest modes, besides what the joints leave free to move without strain."""
    mass = part.free.T @ part.element.mass @ part.free
    stiffness = part.free.T @ part.stiffness @ part.free
    values, shapes = lowest_modes(mass, stiffness, min(count + 6, len(mass)))
    still = int(np.count_nonzero(values <= STILL * slowest_rate(mass, stiffness)))
    return np.asarray(part.free @ shapes[:, : still + count])


def _energy_of(matrix: FloatArray, shapes: FloatArray) -> FloatArray:
    return np.asarray(np.einsum("ij,ij->j", shapes, matrix @ shapes))
