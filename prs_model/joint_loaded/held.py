"""A part held by its joints: how it gives way to loads, and to what moves beyond them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import null_space, pinvh

from ..arrays import FloatArray
from ..joints.compliance import elastic_and_rigid
from ..linear_algebra import lowest_modes, slowest_rate
from ..reduction import SuperElement
from .grips import Grip

STILL = 1e-8  # of the slowest rate of a coordinate: the eigenvalue of a motion that the joints leave free
SINGULAR = 1e-11  # of the largest eigenvalue of a matrix of unit diagonal


@dataclass(frozen=True, eq=False)
class Held:
    """A part of n coordinates, held by its joints whose far ends stand still."""

    element: SuperElement
    grips: Sequence[Grip]

    @cached_property
    def springs(self) -> list[tuple[FloatArray, FloatArray]]:
        """Of each grip the stiffness (m, m) of what gives way, and the wrenches (m, r) of what is rigid."""
        return [elastic_and_rigid(grip.compliance) for grip in self.grips]

    @property
    def signature(self) -> tuple[tuple[int, int, bool], ...]:
        """What parts must have in common for their shapes under joints to correspond."""
        pairs = zip(self.grips, self.springs, strict=True)
        return tuple((len(grip.end), rigid.shape[1], grip.several) for grip, (_, rigid) in pairs)

    @cached_property
    def stiffness(self) -> FloatArray:
        """(n, n): the part's and its springs'."""
        pairs = zip(self.grips, self.springs, strict=True)
        return np.asarray(self.element.stiffness + sum(grip.end.T @ k @ grip.end for grip, (k, _) in pairs))

    @cached_property
    def rows(self) -> FloatArray:
        """(r, n): what rigid joints hold."""
        pairs = zip(self.grips, self.springs, strict=True)
        return np.vstack([np.zeros((0, self.element.size)), *(rigid.T @ grip.end for grip, (_, rigid) in pairs)])

    @cached_property
    def free(self) -> FloatArray:
        """(n, k): the motions that rigid joints leave."""
        return np.asarray(null_space(self.rows)) if len(self.rows) else np.eye(self.element.size)

    @cached_property
    def still(self) -> FloatArray:
        """(n, k): motions that strain neither part nor joints, such as the spin of a rod between two balls."""
        mass = self.free.T @ self.element.mass @ self.free
        stiffness = self.free.T @ self.stiffness @ self.free
        values, shapes = lowest_modes(mass, stiffness, min(6, len(mass)))
        return np.asarray(self.free @ shapes[:, values <= STILL * slowest_rate(mass, stiffness)])

    def under(self, loads: FloatArray) -> FloatArray:
        """The shapes (n, c) under loads (n, c)."""
        return np.asarray(self._flexibility @ loads)

    def following(self, moved: Grip, motions: FloatArray) -> FloatArray:
        """The shapes (n, c) when the far ends of one grip are moved by motions (m, c)."""
        loads, rows = np.zeros((self.element.size, motions.shape[1])), [np.zeros((0, motions.shape[1]))]
        for grip, (stiffness, rigid) in zip(self.grips, self.springs, strict=True):
            motion = motions if grip is moved else np.zeros((len(grip.end), motions.shape[1]))
            loads += grip.end.T @ stiffness @ motion
            rows.append(rigid.T @ motion)
        carried = np.linalg.lstsq(self.rows, np.vstack(rows), rcond=None)[0] if len(self.rows) else 0.0 * loads
        return np.asarray(carried + self._flexibility @ (loads - self.stiffness @ carried))

    @cached_property
    def _flexibility(self) -> FloatArray:
        stiffness = self.free.T @ self.stiffness @ self.free
        diagonal = np.diag(stiffness)
        scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
        scaled = self.free * scale
        return np.asarray(scaled @ pinvh(stiffness * np.outer(scale, scale), rtol=SINGULAR) @ scaled.T)
