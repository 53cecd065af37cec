"""Lowest modes of joined parts with all their DOFs: Ritz vectors of every part, more until the residual is small."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from ..errors import PrsError
from ..reduction.super_element import SuperElement
from ..synthesis import System
from .inverse import Joined, Shapes
from .subspace import Subspace, enlarged

Synthesis = Callable[[Mapping[str, SuperElement]], System]

MORE = 2  # modes improved beyond those asked for, which may change places with them
MOST_ITERATIONS = 20
ACCURACY = 5e-5  # of a mode; its frequency is then good to about the square, 1e-9

logger = logging.getLogger("prs_model")


@dataclass(frozen=True, eq=False)
class Solution:
    """shapes of every body, mass-normalised over all; residuals (c,) of squared frequencies, relative; iterations."""

    shapes: Shapes
    residuals: FloatArray
    iterations: int


def lowest(joined: Joined, spaces: Mapping[str, Subspace], synthesis: Synthesis, count: int) -> Solution:
    """The `count` lowest modes, sought in subspaces of the parts to begin with.

    The assembly of the subspaces gives Ritz pairs (theta, x) of A = K - s M and M. With e = theta A^-1 M x - x, the
    residual r = |e| / |x| in the norm of A says that an eigenvalue lies within r of theta, relative, and about r^2
    where no other is as near. Where it is too large, e enlarges the subspaces, each body by its own share: as good as
    block inverse iteration, and better, because bodies are combined anew. Raises PrsError when it does not come to
    rest.
    """
    shift = next(iter(joined.bodies.values())).shift
    for iteration in range(1, MOST_ITERATIONS + 1):
        modes = synthesis({name: space.element() for name, space in spaces.items()}).modes(count + MORE)
        shapes = {name: space.vectors @ modes.body_shapes(name) for name, space in spaces.items()}
        inverse = joined.solve({name: part.model.mass @ shapes[name] for name, part in joined.bodies.items()})
        values = modes.eigenvalues - shift
        errors = {name: inverse[name] * values - shapes[name] for name in spaces}
        residuals = np.sqrt(joined.energy(errors) / values)
        logger.debug("complete order: residuals %s", " ".join(f"{each:.1e}" for each in residuals))
        if np.all(residuals[:count] <= ACCURACY):
            return Solution({name: each[:, :count] for name, each in shapes.items()}, residuals[:count], iteration)
        moving = residuals > ACCURACY
        spaces = {name: enlarged(space, errors[name][:, moving]) for name, space in spaces.items()}
    raise PrsError(f"the complete-order modes did not come to rest in {MOST_ITERATIONS} iterations")
