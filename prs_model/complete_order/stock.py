"""The parts of a machine with all their DOFs: each kind read and factorized once, when it is first needed."""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np

from .. import plugins
from ..arrays import FloatArray
from ..description import MachineDescription
from ..description.schema import Body, Coupling
from ..errors import PartFileError
from ..finite_elements import FiniteElementModel
from ..joints import ElasticJoint
from ..kinematics import Configuration
from ..linear_algebra import Solve
from ..reduction.interfaces import STILL, interface_ties
from ..reduction.made import checked_model
from ..reduction.recipe import Settings
from ..reduction.request import asked
from ..reduction.surface import Skin, skin
from .part import CompletePart, shifted, tied_part
from .subspace import Subspace, response_space

SLOW = 1e-2  # the shift's share of the joints' stiffness over the machine's mass
DEPTH = 4  # blocks of responses in the first subspaces
SAME = 9  # decimals of a joint value [m] up to which two contacts are at one place

logger = logging.getLogger("prs_model")


class Stock:
    """The parts of a machine, every interface with nodes of its own, averaged or rigid."""

    def __init__(self, description: MachineDescription, joints: tuple[ElasticJoint, ...], coupling: Coupling):
        self.description, self.joints = description, joints
        self.settings = Settings(coupling, "interface", 0)
        self._models: dict[str, FiniteElementModel] = {}
        self._skins: dict[str, Skin | None] = {}
        self._free: dict[str, Solve] = {}
        self._spaces: dict[str, Subspace] = {}
        self._shift: float | None = None

    def subspaces(self, configuration: Configuration) -> dict[str, Subspace]:
        """The part of every body with its interfaces where they are in a configuration, and motions to start from.

        Those of a part whose contact travels are kept for this configuration only. Raises PartFileError for a part that
        comes reduced.
        """
        here: dict[tuple[str, bytes], Subspace] = {}
        return {name: self._subspace(name, configuration, here) for name in self.description.bodies}

    def _subspace(self, name: str, configuration: Configuration, here: dict[tuple[str, bytes], Subspace]) -> Subspace:
        stem, moved = self.description.stems[name], _moved(self.description.bodies[name], configuration)
        shift = self._shift_for(configuration)
        if moved is None:
            if stem not in self._spaces:
                self._spaces[stem] = self._started(stem, self._part(name, STILL, shift))
            return self._spaces[stem]
        key = stem, moved.tobytes()
        if key not in here:
            here[key] = self._started(name, self._part(name, moved, shift))
        return here[key]

    @staticmethod
    def _started(name: str, part: CompletePart) -> Subspace:
        space = response_space(part, DEPTH)
        logger.info("%s: factorized, %d interface nodes, %d motions to start from", name, len(part.ties), space.size)
        return space

    def _part(self, name: str, moved: FloatArray, shift: float) -> CompletePart:
        """The part of a body, its travelling contact moved by `moved` (3,) [m]."""
        stem, body, model = self.description.stems[name], self.description.bodies[name], self._model(name)
        if stem not in self._skins:
            self._skins[stem] = skin(model)
        ties = interface_ties(model, body.interfaces, self.settings, moved)
        return tied_part(
            model, ties, self._skins[stem], shift, lambda: self._factorized(stem, shift), grounded=body.grounded
        )

    def _model(self, name: str) -> FiniteElementModel:
        stem, body = self.description.stems[name], self.description.bodies[name]
        if stem not in self._models:
            self._models[stem] = full_part(stem, body, self.description.folder)
        return self._models[stem]

    def _factorized(self, stem: str, shift: float) -> Solve:
        """Of the part without ties, which all its averaged ones share."""
        if stem not in self._free:
            self._free[stem] = shifted(self._models[stem], shift)
        return self._free[stem]

    def _shift_for(self, configuration: Configuration) -> float:
        """s < 0 [rad^2/s^2], slow beside the joints, to hold free parts a little; the first pose decides."""
        if self._shift is None:
            values, placement = configuration.joint_values, configuration.placement
            springs = [spring for joint in self.joints for spring in joint.springs(values, placement)]
            stiffness = sum(float(np.trace(spring.law.stiffness[:3, :3])) for spring in springs)
            mass = sum(self._model(name).mass_properties().mass for name in self.description.bodies)
            self._shift = -SLOW * stiffness / mass
        return self._shift


def full_part(name: str, body: Body, folder: Path) -> FiniteElementModel:
    """The full matrices of a body, past the physics gate, with what it clamps held.

    Raises PartFileError for one that comes reduced, and what reading and the gate raise.
    """
    request = asked(name, body, folder)[1]
    part = plugins.read(body.reducer, request)
    if not isinstance(part, FiniteElementModel):
        raise PartFileError(request.source or name, f"{name} comes reduced: the complete order needs full matrices")
    logger.info("%s: %d DOFs", name, part.size)
    return checked_model(part, body, name, str(request.source or name))


def _moved(body: Body, configuration: Configuration) -> FloatArray | None:
    """How far (3,) [m] the travelling interface of a body has moved; None for a body that has none."""
    for interface in body.interfaces.values():
        if (travel := interface.travel) is not None:
            direction = np.array(travel.along, dtype=float)
            stroke = np.round(configuration.joint_values[travel.joint], SAME)
            return np.asarray(direction / np.linalg.norm(direction) * stroke)
    return None
