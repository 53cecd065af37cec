"""What the machine itself does to its parts: its lowest modes at a few poses, with all that parts were stored with."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from scipy.stats import qmc

from ..arrays import FloatArray
from ..description import MachineDescription
from ..errors import UnreachablePoseError
from ..joints import ElasticJoint
from ..kinematics import Configuration
from ..reduction import SuperElement, TravellingElement
from ..synthesis import assemble

POSES = 4  # besides the reference
MODES = 12

Snapshot = tuple[Configuration, Mapping[str, FloatArray]]
"""A configuration, and of each body the shapes (n, k) on its coordinates, each mode with one unit of strain energy."""


def snapshots(
    description: MachineDescription,
    parts: Mapping[str, SuperElement | TravellingElement],
    joints: Sequence[ElasticJoint],
    configuration: Callable[..., Configuration],
) -> list[Snapshot]:
    """The machine's lowest modes at the reference and at poses spread over its workspace, those that it reaches."""
    return [_snapshot(description, parts, joints, each) for each in _configurations(description, configuration)]


def _snapshot(
    description: MachineDescription,
    parts: Mapping[str, SuperElement | TravellingElement],
    joints: Sequence[ElasticJoint],
    configuration: Configuration,
) -> Snapshot:
    modes = assemble(description, parts, joints, configuration).modes(MODES)
    size = np.sqrt(modes.eigenvalues[~modes.is_rigid])
    return configuration, {name: modes.body_shapes(name)[:, ~modes.is_rigid] / size for name in parts}


def _configurations(
    description: MachineDescription, configuration: Callable[..., Configuration]
) -> list[Configuration]:
    """The reference, and points of Halton's sequence in the workspace."""
    found = [configuration()]
    bounds = np.array(list(description.workspace.values())).reshape(-1, 2)
    if not len(bounds):
        return found
    for point in qmc.Halton(len(bounds), scramble=False).random(POSES + 1)[1:]:
        values = bounds[:, 0] + point * (bounds[:, 1] - bounds[:, 0])
        try:
            found.append(configuration(**dict(zip(description.workspace, values.tolist(), strict=True))))
        except UnreachablePoseError:
            continue
    return found
