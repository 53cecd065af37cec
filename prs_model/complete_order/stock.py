"""The parts of a machine with all their DOFs: each kind read and factorized once, when it is first needed."""

from __future__ import annotations

import logging
from functools import cached_property
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
from ..reduction.kinds import Kind, kind_of
from ..reduction.made import checked_model
from ..reduction.recipe import Settings
from ..reduction.request import asked
from ..reduction.stations import shift_of, travelling_interface
from ..reduction.surface import Skin, skin
from .part import CompletePart, shifted, tied_part
from .subspace import Subspace, response_space

SLOW = 1e-2  # the shift's share of the joints' stiffness over the machine's mass
DEPTH = 4  # blocks of responses in the first subspaces
HELD = 1e-6  # its share of the parts' least K_ii/M_ii, where no joint is elastic along an axis

logger = logging.getLogger("prs_model")


class Stock:
    """The parts of a machine, every member of an interface with a node of its own.

    These are averaged or rigid, as `coupling` says, or the interface's own coupling.
    """

    def __init__(self, description: MachineDescription, joints: tuple[ElasticJoint, ...], coupling: Coupling):
        self.description, self.joints = description, joints
        self.bodies = {name: _with_own_nodes(body) for name, body in description.bodies.items()}
        self.settings = Settings(coupling, "interface", 0)
        self._models: dict[Kind, FiniteElementModel] = {}
        self._skins: dict[Kind, Skin | None] = {}
        self._free: dict[Kind, Solve] = {}
        self._spaces: dict[Kind, Subspace] = {}
        self._shift: float | None = None

    @cached_property
    def kinds(self) -> dict[str, Kind]:
        """The kind of every body. Raises what asking for a part raises."""
        stems, folder = self.description.stems, self.description.folder
        return {name: kind_of(stems[name], body, folder, self.settings) for name, body in self.bodies.items()}

    def subspaces(self, configuration: Configuration) -> dict[str, Subspace]:
        """The part of every body with its interfaces where they are in a configuration, and motions to start from.

        Those of a part whose contact travels are kept for this configuration only. Raises PartFileError for a part that
        comes reduced.
        """
        here: dict[tuple[Kind, tuple[float, ...]], Subspace] = {}
        return {name: self._subspace(name, configuration, here) for name in self.bodies}

    def _subspace(
        self, name: str, configuration: Configuration, here: dict[tuple[Kind, tuple[float, ...]], Subspace]
    ) -> Subspace:
        kind, shift = self.kinds[name], self._shift_for(configuration)
        found = travelling_interface(self.bodies[name].interfaces, name)
        if found is None:
            if kind not in self._spaces:
                self._spaces[kind] = self._started(kind.stem, self._part(name, STILL, shift))
            return self._spaces[kind]
        moved = shift_of(found[1], configuration.joint_values[found[1].joint])
        key = kind, tuple(moved.tolist())
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
        kind, body, model = self.kinds[name], self.bodies[name], self._model(name)
        if kind not in self._skins:
            self._skins[kind] = skin(model)
        ties = interface_ties(model, body.interfaces, self.settings, moved)
        return tied_part(
            model, ties, self._skins[kind], shift, lambda: self._factorized(kind, shift), grounded=body.grounded
        )

    def _model(self, name: str) -> FiniteElementModel:
        kind = self.kinds[name]
        if kind not in self._models:
            self._models[kind] = full_part(kind.stem, self.bodies[name], self.description.folder)
        return self._models[kind]

    def _factorized(self, kind: Kind, shift: float) -> Solve:
        """Of the part without ties, which all its averaged ones share."""
        if kind not in self._free:
            self._free[kind] = shifted(self._models[kind], shift)
        return self._free[kind]

    def _shift_for(self, configuration: Configuration) -> float:
        """s < 0 [rad^2/s^2], slow beside the joints, or else the parts, to hold free parts; the first pose decides."""
        if self._shift is None:
            values, placement = configuration.joint_values, configuration.placement
            springs = [spring for joint in self.joints for spring in joint.springs(values, placement)]
            stiffness = sum(float(np.trace(spring.law.stiffness[:3, :3])) for spring in springs)
            models = [self._model(name) for name in self.bodies]
            if stiffness > 0.0:
                self._shift = -SLOW * stiffness / sum(model.mass_properties().mass for model in models)
            else:
                self._shift = -HELD * min(_slowest_rate(model) for model in models)
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


def _with_own_nodes(body: Body) -> Body:
    """The body without what its interfaces say of `tie`."""
    interfaces = {name: each.model_copy(update={"tie": None}) for name, each in body.interfaces.items()}
    return body.model_copy(update={"interfaces": interfaces})


def _slowest_rate(model: FiniteElementModel) -> float:
    """The least K_ii / M_ii [rad^2/s^2] of the DOFs that have both."""
    stiffness, mass = model.stiffness.diagonal(), model.mass.diagonal()
    both = (stiffness > 0.0) & (mass > 0.0)
    return float(np.min(stiffness[both] / mass[both], initial=np.inf))
