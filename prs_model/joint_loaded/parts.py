"""Parts that await their joints become super-elements in the shapes that these can give them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ..arrays import FloatArray
from ..description import MachineDescription
from ..description.settings import Settings
from ..joints import ElasticJoint
from ..kinematics import Configuration
from ..reduction import SuperElement, TravellingElement
from ..reduction.from_model import AWAITS_JOINTS
from ..reduction.gate import JOINT_LOADED
from .basis import Held, joint_loaded_basis, reach_of, rigid_and_elastic, static_shapes
from .grips import grips

Part = SuperElement | TravellingElement


def joint_loaded_parts(
    description: MachineDescription,
    parts: Mapping[str, Part],
    joints: Sequence[ElasticJoint],
    reference: Callable[[], Configuration],
) -> dict[str, Part]:
    """The parts of a machine, those that await their joints reduced to their shapes under them.

    Joints are taken as they are in the reference configuration; how stiff they are matters to the shapes only, the
    springs themselves stay in the assembly. Raises PhysicsError for a travelling part that does not interpolate.
    """
    if not any(_awaits(part) for part in parts.values()):
        return dict(parts)
    there = reference()
    return {
        name: _loaded(name, part, description, joints, there) if _awaits(part) else part for name, part in parts.items()
    }


def _awaits(part: Part) -> bool:
    first = part if isinstance(part, SuperElement) else part.elements[0]
    return first.provenance.get("basis") == AWAITS_JOINTS


def _loaded(
    name: str, part: Part, description: MachineDescription, joints: Sequence[ElasticJoint], reference: Configuration
) -> Part:
    body = description.bodies[name]

    def held(element: SuperElement, at: Configuration) -> Held:
        return Held(element, grips(name, element, joints, at, body.frame, reference))

    if isinstance(part, TravellingElement):
        stations = [reference.moved({part.joint: value}) for value in part.stations.tolist()]
        return _travelling(part, [held(*each) for each in zip(part.elements, stations, strict=True)])
    modes = Settings.of(body, description.file.reduction).modes
    return _in_shapes(part, joint_loaded_basis(held(part, reference), modes))


def _travelling(part: TravellingElement, stations: Sequence[Held]) -> TravellingElement:
    """In static shapes and in the modes that it came with: the same combinations of them at every station.

    Both are smooth along the way; modes under the joints would change places. A free part's rigid motions come first:
    they strain nothing, and the stiffness of the rest is positive definite, and interpolated so that it stays so.
    """
    middle = len(stations) // 2
    reach = reach_of(part.elements[middle])
    statics = [static_shapes(station, reach) for station in stations]
    rigid, elastic = rigid_and_elastic(stations[middle], statics[middle])
    modes = np.eye(part.size)[:, part.size - part.n_modes :]
    bases = [np.hstack([static @ rigid, static @ elastic, modes]) for static in statics]
    elements = tuple(_in_shapes(element, basis) for element, basis in zip(part.elements, bases, strict=True))
    if (products := part.products) is not None:
        products = np.einsum("iab,ijac,jcd->ijbd", bases, products, bases, optimize=True)
    strained = tuple(range(rigid.shape[1], bases[0].shape[1]))
    loaded = replace(part, elements=elements, products=products, contact=strained)
    loaded.check()
    return loaded


def _in_shapes(element: SuperElement, basis: FloatArray) -> SuperElement:
    """An element on the coordinates of a basis (n, r)."""
    stiffness, mass = (basis.T @ matrix @ basis for matrix in (element.stiffness, element.mass))
    return replace(
        element,
        stiffness=(stiffness + stiffness.T) / 2.0,
        mass=(mass + mass.T) / 2.0,
        motions=element.motions @ basis,
        n_modes=0,
        surface=None if element.surface is None else element.surface.through(basis),
        labels=tuple(f"shape {i + 1}" for i in range(basis.shape[1])),
        provenance={**element.provenance, "basis": JOINT_LOADED, "modes": JOINT_LOADED},
    )
