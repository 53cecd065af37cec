"""The two ways of interpolating: a frame of the lowest modes where a gap follows them, a Ritz basis where none does."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from ..arrays import FloatArray
from .exact import Solved, Solver
from .frames import Frame, in_frame
from .in_frame import carried, reaches
from .interpolation import Interpolation
from .request import Request
from .ritz import RitzBasis, RitzInterpolation, leading_shapes, ritz_matrices

EXTRA = 9  # modes above those asked for, among which a gap is sought
_LEAST_GAP = 1.04  # ratio of eigenvalues above and below it
_GOOD_GAP = 1.1
_LEAST_ALIGNMENT = 0.3
_FOLLOWED = 4  # modes above those asked for, whose shapes make a Ritz basis too
_ABOVE = 1.3  # times the highest eigenvalue asked for: the level at which a Ritz basis is counted


class NotSmoothError(Exception):
    """Why an interpolation does not serve, in words."""


class Approach(Protocol):
    """What is interpolated."""

    @property
    def main(self) -> str:
        """The matrices that eigenvalues come from."""

    @property
    def wanted(self) -> float:
        """The error of them that is allowed."""

    @property
    def count(self) -> int:
        """Modes that are needed at a node."""

    def on_line(self, solved: Solved) -> FloatArray:
        """The main matrices (N, e), packed."""

    def at_nodes(self, solved: Solved) -> dict[str, FloatArray]:
        """All that is interpolated (N, ..)."""

    def interpolation(self, shapes: Mapping[str, tuple[int, ...]], **tensor: Any) -> Interpolation | RitzInterpolation:
        """Of a tensor, with shapes at one pose of what is in it."""

    @property
    def level(self) -> float | None:
        """Below which eigenvalues are counted [rad^2/s^2]; None where there are no others."""

    def words(self) -> str:
        """What is followed."""


@dataclass(frozen=True)
class Following:
    """The lowest modes in a frame that turns with them."""

    frame: Frame
    request: Request
    main: str = "logarithm"

    @property
    def wanted(self) -> float:
        return 2.0 * self.request.tolerance

    @property
    def count(self) -> int:
        return self.frame.size + 1

    @property
    def level(self) -> float | None:
        return self.frame.level

    def on_line(self, solved: Solved) -> FloatArray:
        return self._matrices(solved)["logarithm"]

    def at_nodes(self, solved: Solved) -> dict[str, FloatArray]:
        matrices = self._matrices(solved)
        frames = matrices.pop("frames")
        only = self.request.quantities == ("frequency",)
        return matrices | ({} if only else carried(solved.systems, frames, self.request))

    def interpolation(self, shapes: Mapping[str, tuple[int, ...]], **tensor: Any) -> Interpolation:
        own = ("logarithm", "joints")
        return Interpolation(
            **tensor, frame=self.frame, shapes={name: each for name, each in shapes.items() if name not in own}
        )

    def words(self) -> str:
        level = self.frame.level
        below = "" if level is None else f", below {np.sqrt(level) / (2.0 * np.pi):.1f} Hz"
        return f"{self.frame.size} modes followed together{below}"

    def _matrices(self, solved: Solved) -> dict[str, FloatArray]:
        """Packed L, and the frames W. Raises NotSmoothError where the frame does not fit, or another mode comes in."""
        frame, values = self.frame, solved.modes.eigenvalues
        found = in_frame(frame, solved.systems, solved.modes)
        if found.alignment.min() < _LEAST_ALIGNMENT:
            raise NotSmoothError("the low shapes change too much over the poses")
        if frame.level is not None and values.shape[1] > frame.size and np.any(values[:, frame.size] < frame.level):
            raise NotSmoothError("another mode comes below the level")
        rows, columns = np.tril_indices(frame.size)
        return {"logarithm": found.logarithms[:, rows, columns], "frames": found.frames}


@dataclass(frozen=True)
class RitzOnInverse:
    """One basis for all poses. least: the smallest mu = 1 / (lambda - shift) of the modes asked for [s^2/rad^2]."""

    basis: RitzBasis
    request: Request
    least: float
    main: str = "inverse"

    @property
    def wanted(self) -> float:
        return self.request.tolerance * self.least

    @property
    def count(self) -> int:
        return self.request.n_modes

    @property
    def level(self) -> float | None:
        return self.basis.level

    def on_line(self, solved: Solved) -> FloatArray:
        return self.at_nodes(solved)["inverse"]

    def at_nodes(self, solved: Solved) -> dict[str, FloatArray]:
        return ritz_matrices(self.basis, solved.systems)

    def interpolation(self, shapes: Mapping[str, tuple[int, ...]], **tensor: Any) -> RitzInterpolation:
        return RitzInterpolation(**tensor, basis=self.basis)

    def words(self) -> str:
        level = np.sqrt(self.basis.level) / (2.0 * np.pi)
        return f"{self.basis.size} shapes for all poses, counted below {level:.1f} Hz"


def following(request: Request, solver: Solver, home: Solved, eigenvalues: FloatArray) -> Following:
    """The smallest number of modes above which there is a good gap, or else that with the widest.

    eigenvalues (N, k): at samples. Raises NotSmoothError where there is none, or the band reaches beyond all of them.
    """
    n, available = request.n_modes, eigenvalues.shape[1]
    if available < n:
        raise NotSmoothError(f"only {available} modes")
    if available < solver.count:
        return Following(Frame(home.modes.shapes[0], solver.shift, None), request)
    shifted = eigenvalues - solver.shift
    left_out = np.sqrt(np.maximum(eigenvalues.min(axis=0)[n:], 0.0)) / (2.0 * np.pi)
    enough = np.array([reaches(request, each) for each in left_out.tolist()])
    if not enough.any():
        raise NotSmoothError("the band reaches beyond the modes that are followed")
    gaps = np.where(enough, shifted[:, n:].min(axis=0) / shifted[:, n - 1 : -1].max(axis=0), 0.0)
    if gaps.max() < _LEAST_GAP:
        raise NotSmoothError(f"no gap above any of modes {n} to {n + len(gaps) - 1}")
    p = n + int(np.argmax(gaps > _GOOD_GAP) if gaps.max() > _GOOD_GAP else np.argmax(gaps))
    level = float(np.sqrt(shifted[:, p - 1].max() * shifted[:, p].min())) + solver.shift
    return Following(Frame(home.modes.shapes[0][:, :p], solver.shift, level), request)


def ritz_on_inverse(
    request: Request, solver: Solver, home: Solved, samples: Sequence[Solved], size: int
) -> RitzOnInverse:
    """A basis of `size` shapes from samples all over the poses. Raises NotSmoothError for what has more to carry."""
    if request.quantities != ("frequency",):
        raise NotSmoothError("shapes in one basis for all poses give frequencies only")
    n, values = request.n_modes, np.concatenate([each.modes.eigenvalues for each in samples])
    if values.shape[1] < n:
        raise NotSmoothError(f"only {values.shape[1]} modes")
    shapes = np.concatenate([each.modes.shapes[:, :, : n + _FOLLOWED] for each in samples])
    columns = shapes.swapaxes(0, 1).reshape(shapes.shape[1], -1)
    shift = solver.shift if solver.shift < 0.0 else -1e-2 * float(values[:, 0].max())
    highest = float(values[:, n - 1].max())
    basis = RitzBasis(leading_shapes(home.systems.mass[0], columns, size), shift, _ABOVE * highest)
    if basis.first < n + _FOLLOWED:
        raise NotSmoothError(f"a basis of {basis.size} shapes is too small")
    return RitzOnInverse(basis, request, 1.0 / (highest - shift))
