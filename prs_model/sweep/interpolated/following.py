"""Which modes are followed together: those above which a gap stays open in the spectrum."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...arrays import FloatArray
from ..exact import Solved, Solver
from ..in_frame import carried, reaches
from ..not_smooth import NotSmoothError
from ..request import Request
from .frames import Frame, in_frame
from .interpolation import Interpolation

EXTRA = 9  # modes above those asked for, among which a gap is sought
_LEAST_GAP = 1.04  # ratio of eigenvalues above and below it
_GOOD_GAP = 1.1
_LEAST_ALIGNMENT = 0.3


@dataclass(frozen=True)
class Following:
    """The lowest modes in a frame that turns with them.

    gap: the eigenvalues below and above it, as far as is known [rad^2/s^2]; None where all modes are followed.
    """

    frame: Frame
    request: Request
    gap: tuple[float, float] | None

    @property
    def count(self) -> int:
        """Modes that are needed at a node."""
        return self.frame.size + 1

    def level(self, share: float = 0.5) -> float | None:
        """An eigenvalue in the gap, that share of the way up [rad^2/s^2]."""
        if self.gap is None:
            return None
        low, high = (each - self.frame.shift for each in self.gap)
        return float(low ** (1.0 - share) * high**share) + self.frame.shift

    def on_line(self, solved: Solved) -> FloatArray:
        """L (N, e), packed."""
        return self._matrices(solved)["logarithm"]

    def at_nodes(self, solved: Solved) -> dict[str, FloatArray]:
        """All that is interpolated (N, ..)."""
        matrices = self._matrices(solved)
        frames = matrices.pop("frames")
        only = self.request.quantities == ("frequency",)
        return matrices | ({} if only else carried(solved.systems, frames, self.request))

    def interpolation(self, shapes: Mapping[str, tuple[int, ...]], **tensor: Any) -> Interpolation:
        """Of a tensor, with shapes at one pose of what is in it."""
        own = ("logarithm", "joints")
        return Interpolation(
            **tensor, frame=self.frame, shapes={name: each for name, each in shapes.items() if name not in own}
        )

    def words(self) -> str:
        """What is followed."""
        level = self.level()
        below = "" if level is None else f", below {np.sqrt(level) / (2.0 * np.pi):.1f} Hz"
        return f"{self.frame.size} modes followed together{below}"

    def _matrices(self, solved: Solved) -> dict[str, FloatArray]:
        """Packed L, and the frames W. Raises NotSmoothError where the frame does not fit, or another mode comes in."""
        frame, values, level = self.frame, solved.modes.eigenvalues, self.level()
        found = in_frame(frame, solved.systems, solved.modes)
        if found.alignment.min() < _LEAST_ALIGNMENT:
            raise NotSmoothError("the low shapes change too much over the poses")
        if level is not None and values.shape[1] > frame.size and np.any(values[:, frame.size] < level):
            raise NotSmoothError("another mode comes in among those that are followed")
        rows, columns = np.tril_indices(frame.size)
        return {"logarithm": found.logarithms[:, rows, columns], "frames": found.frames}


def following(request: Request, solver: Solver, home: Solved, eigenvalues: FloatArray) -> Following:
    """The smallest number of modes above which there is a good gap, or else that with the widest.

    eigenvalues (N, k): at samples. Raises NotSmoothError where there is none, or the band reaches beyond all of them.
    """
    n, available = request.n_modes, eigenvalues.shape[1]
    if available < n:
        raise NotSmoothError(f"only {available} modes")
    if available < solver.count:
        return Following(Frame(home.modes.shapes[0], solver.shift), request, None)
    shifted = eigenvalues - solver.shift
    left_out = np.sqrt(np.maximum(eigenvalues.min(axis=0)[n:], 0.0)) / (2.0 * np.pi)
    enough = np.array([reaches(request, each) for each in left_out.tolist()])
    if not enough.any():
        raise NotSmoothError("the band reaches beyond the modes that are followed")
    gaps = np.where(enough, shifted[:, n:].min(axis=0) / shifted[:, n - 1 : -1].max(axis=0), 0.0)
    if gaps.max() < _LEAST_GAP:
        raise NotSmoothError(f"no gap above any of modes {n} to {n + len(gaps) - 1}")
    p = n + int(np.argmax(gaps > _GOOD_GAP) if gaps.max() > _GOOD_GAP else np.argmax(gaps))
    gap = float(eigenvalues[:, p - 1].max()), float(eigenvalues[:, p].min())
    return Following(Frame(home.modes.shapes[0][:, :p], solver.shift), request, gap)
