"""A^-1 of parts joined by springs, by the Woodbury identity: the parts factorized one by one, the springs brought in.

A = K - s M of the joined machine is A_0 + D^T S D: A_0 the parts' own, factorized once; S the springs on the motions
U = D u of the interface nodes. Rigid joints leave U = E z. Then A u = b has u = A_0^-1 b - Y f with Y = A_0^-1 D^T,
H = D Y, and forces f from [[H, E], [E^T, -S_z]] [f; z] = [D A_0^-1 b; 0] (W. W. Hager, Updating the inverse of a
matrix, SIAM Review 31, 1989).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import block_diag, lu_factor, lu_solve

from ..arrays import FloatArray
from .part import CompletePart

Shapes = dict[str, FloatArray]
"""(n, c) of every body, on its own n DOFs."""


@dataclass(frozen=True, eq=False)
class Joined:
    """Parts (one CompletePart may stand for several bodies) and what joins them in one configuration.

    bodies: the part of each body. springs: S_z (m, m) on the coordinates z of `expansion`, E (6 k, m), for the k nodes
    of all bodies in their order.
    """

    bodies: Mapping[str, CompletePart]
    springs: FloatArray
    expansion: FloatArray

    @property
    def size(self) -> int:
        """Number of DOFs."""
        return sum(part.size for part in self.bodies.values())

    def solve(self, loads: Shapes) -> Shapes:
        """A^-1 b; bodies of one part are solved together."""
        free: Shapes = {}
        for part, names in _by_part(self.bodies):
            stacked = part.solve(np.hstack([loads[name] for name in names]))
            free |= dict(zip(names, np.split(stacked, len(names), axis=1), strict=True))
        motions = np.vstack([part.outputs @ free[name] for name, part in self.bodies.items()])
        edges = np.cumsum([6 * len(part.ties) for part in self.bodies.values()])[:-1]
        forces = np.split(self._forces(motions), edges)
        return {
            name: free[name] - part.responses @ force
            for (name, part), force in zip(self.bodies.items(), forces, strict=True)
        }

    def energy(self, shapes: Shapes) -> FloatArray:
        """u^T A u (c,) of shapes that obey the rigid joints."""
        motions = np.vstack([part.outputs @ shapes[name] for name, part in self.bodies.items()])
        independent = np.linalg.lstsq(self.expansion, motions, rcond=None)[0]
        energy = np.einsum("ic,ij,jc->c", independent, self.springs, independent, optimize=True)
        for name, part in self.bodies.items():
            own = shapes[name]
            energy += np.einsum("ic,ic->c", own, part.model.stiffness @ own - part.shift * (part.model.mass @ own))
        return np.asarray(energy)

    def _forces(self, motions: FloatArray) -> FloatArray:
        """f (6 k, c) of the joints on the nodes, that would move by `motions` without them."""
        scale, saddle = self._saddle
        right = np.vstack([motions, np.zeros((len(scale) - len(motions), motions.shape[1]))])
        return (scale * lu_solve(saddle, scale * right))[: len(motions)]

    @cached_property
    def _saddle(self) -> tuple[FloatArray, tuple[FloatArray, NDArray[np.integer]]]:
        """The scale of its rows, without which forces of newtons meet motions of nanometres, and the factors."""
        flexibility = block_diag(*(part.flexibility for part in self.bodies.values()))
        force = 1.0 / np.sqrt(np.diag(flexibility))
        motion = 1.0 / np.linalg.norm(force[:, None] * self.expansion, axis=0)
        scale = np.concatenate([force, motion])
        saddle = np.block([[flexibility, self.expansion], [self.expansion.T, -self.springs]])
        return scale[:, None], lu_factor(saddle * np.outer(scale, scale))


def _by_part(bodies: Mapping[str, CompletePart]) -> list[tuple[CompletePart, list[str]]]:
    """Each part with the bodies that it stands for."""
    names: dict[int, list[str]] = {}
    for name, part in bodies.items():
        names.setdefault(id(part), []).append(name)
    return [(bodies[group[0]], group) for group in names.values()]
