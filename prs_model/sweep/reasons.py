"""Why poses are unreachable, as codes for many poses at once, and the codes in words."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..arrays import FloatArray

if TYPE_CHECKING:
    from ..kinematics.reach import Reach

REACHABLE, NO_CONFIGURATION, _FIRST_LIMIT = 0, 1, 2


def reason_codes(reach: Reach, q: FloatArray) -> NDArray[np.int16]:
    """The code (N,) of each configuration (N, n) [m, rad]: 0 reachable, 1 none (NaN), else the joint that is furthest
    beyond its limits for its range: 2 + 2 j below the lower one of joint j, 3 + 2 j above the upper one."""
    worst = reach.worst(q)
    above = (q > reach.tree.upper)[np.arange(len(q)), worst] if q.shape[1] else np.zeros(len(q), dtype=bool)
    codes = np.where(worst >= 0, _FIRST_LIMIT + 2 * worst + above, REACHABLE)
    return np.where(np.isnan(q).any(axis=1), NO_CONFIGURATION, codes).astype(np.int16)


def sentences(reach: Reach, codes: NDArray[np.int16]) -> dict[int, str]:
    """The codes that occur among `codes`, and reachable, in words such as ``slide_2 above its upper limit 900 mm``."""
    return {int(code): _sentence(reach, int(code)) for code in np.union1d(codes, [REACHABLE])}


def _sentence(reach: Reach, code: int) -> str:
    if code == REACHABLE:
        return "reachable"
    if code == NO_CONFIGURATION:
        return "no configuration closes the loops"
    joint, above = divmod(code - _FIRST_LIMIT, 2)
    limit = (reach.tree.upper if above else reach.tree.lower)[joint]
    side = "above its upper limit" if above else "below its lower limit"
    return f"{reach.tree.names[joint]} {side} {reach.joint_text(joint, float(limit))}"
