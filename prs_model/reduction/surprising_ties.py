"""Interfaces that hold more, or stand farther away, than anyone means: said, since nothing else shows it."""

from __future__ import annotations

import logging
from collections.abc import Sequence

import numpy as np

from ..arrays import FloatArray
from ..finite_elements import FiniteElementModel
from ..finite_elements.selection import LENGTHS, point, reach
from .coupling import Tie

MOST = 0.5  # of a part's nodes

logger = logging.getLogger("prs_model")


def warn_of_surprises(model: FiniteElementModel, ties: Sequence[Tie]) -> None:
    """Log a warning for rigid ties of most of the part, and for nodes far outside of it."""
    for tie in ties:
        if tie.coupling == "rigid" and len(tie.indices) > max(1.0, MOST * len(model.coordinates)):
            logger.warning(
                "%s: interface %s holds %d of the part's %d nodes as one rigid body; select its seat only",
                *(model.name, tie.node, len(tie.indices), len(model.coordinates)),
            )
        warn_of_distance(model.name, tie.node, tie.position, model.coordinates[tie.indices], model.coordinates)


def warn_of_distance(name: str, node: str, position: FloatArray, tied: FloatArray, part: FloatArray) -> None:
    """Log a warning for a node at `position` (3,) that stands outside the part (n, 3) [m] by more than its size."""
    low, high = part.min(axis=0), part.max(axis=0)
    outside = float(np.linalg.norm(position - np.clip(position, low, high)))
    if outside > float(np.linalg.norm(high - low)) > 0.0:
        away = float(np.linalg.norm(tied - position, axis=1).min())
        logger.warning(
            "%s: interface %s stands at %s m, %.4g m from the nodes it ties; the part reaches %s; %s",
            *(name, node, point(position), away, reach(part), LENGTHS),
        )
