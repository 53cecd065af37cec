"""Parts that await their joints become super-elements in the shapes that these, and the machine, can give them."""

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
from .basis import apart_from, energy_matrix, equal_in_energy, independent, shapes_under_loads, static_shapes
from .enrichment import Directions, Sight, counts, directions, patterns_beyond
from .held import Held
from .holding import Holding, Part
from .snapshots import Snapshot, snapshots

Kind = tuple[str, ...]
"""Bodies that share one part."""

Shapes = Callable[[Held], FloatArray]
"""Shapes (n, c) of a part as it is held; columns correspond wherever it is."""


def joint_loaded_parts(
    description: MachineDescription,
    parts: Mapping[str, Part],
    joints: Sequence[ElasticJoint],
    configuration: Callable[..., Configuration],
) -> dict[str, Part]:
    """The parts of a machine, those that await their joints reduced to their shapes under them.

    configuration: at a pose, the reference by default. Joints are taken as they are in the reference configuration;
    how stiff they are matters to the shapes only, the springs themselves stay in the assembly.
    Raises PhysicsError for a travelling part that does not interpolate.
    """
    if not any(_awaits(part) for part in parts.values()):
        return dict(parts)
    holding = Holding(description, parts, joints, configuration())
    kinds = _kinds(holding)
    extra = _machine_shapes(holding, kinds, configuration)
    loaded = {name: _loaded(holding, name, extra[kind]) for kind in kinds for name in kind}
    return {name: loaded.get(name, part) for name, part in parts.items()}


def _awaits(part: Part) -> bool:
    return _first(part).provenance.get("basis") == AWAITS_JOINTS


def _first(part: Part) -> SuperElement:
    return part if isinstance(part, SuperElement) else part.elements[0]


def _kinds(holding: Holding) -> list[Kind]:
    """The bodies whose parts await their joints; those with one part, one number of modes and like joints together."""
    kinds: dict[tuple[object, ...], list[str]] = {}
    for name, part in holding.parts.items():
        if _awaits(part):
            grips = holding.held(name, holding.reference).signature
            kinds.setdefault((id(_first(part)), holding.description.bodies[name].modes, *grips), []).append(name)
    return [tuple(names) for names in kinds.values()]


def _machine_shapes(
    holding: Holding, kinds: Sequence[Kind], configuration: Callable[..., Configuration]
) -> dict[Kind, Shapes]:
    """The shapes that the machine's modes ask for besides the static ones.

    Bodies have as many as their `modes` says; those that leave it to the machine share what it gives them all.
    """
    description = holding.description
    modes = {name: Settings.of(body, description.file.reduction).modes for name, body in description.bodies.items()}
    if not any(modes[name] for kind in kinds for name in kind):
        return dict.fromkeys(kinds, _no_shapes)
    samples = snapshots(description, holding.parts, holding.joints, configuration)
    candidates = {kind: _candidates(holding, kind, samples) for kind in kinds}
    ranked = {kind: _ranked(holding, kind, samples, candidates[kind]) for kind in kinds}
    shared = {kind: found for kind, found in ranked.items() if description.bodies[kind[0]].modes is None}
    budget = sum(modes[name] for kind in shared for name in kind)
    taken = {kind: modes[kind[0]] for kind in kinds} | counts(shared, budget)
    return {kind: _combined(candidates[kind], found.combinations[:, : taken[kind]]) for kind, found in ranked.items()}


def _candidates(holding: Holding, kind: Kind, samples: Sequence[Snapshot]) -> Shapes:
    """All shapes of a part; of one whose contact travels those that are smooth along the way.

    These are its shapes when the bodies beyond deform as they do in the machine's modes, and its stored modes.
    """
    part = holding.parts[kind[0]]
    if isinstance(part, SuperElement):
        return lambda held: np.eye(held.element.size)
    seen = [(holding.held(name, at), shapes) for name in kind for at, shapes in samples]
    patterns = patterns_beyond(seen)
    modes = np.eye(part.size)[:, part.size - part.n_modes :]

    def smooth(held: Held) -> FloatArray:
        return np.hstack([*(held.following(held.grips[place], each) for place, each in patterns.items()), modes])

    return smooth


def _ranked(holding: Holding, kind: Kind, samples: Sequence[Snapshot], candidates: Shapes) -> Directions:
    held = [(holding.held(name, at), shapes[name]) for name in kind for at, shapes in samples]
    return directions([Sight(part, own, static_shapes(part), candidates(part)) for part, own in held])


def _combined(candidates: Shapes, combinations: FloatArray) -> Shapes:
    return lambda held: candidates(held) @ combinations


def _no_shapes(held: Held) -> FloatArray:
    return np.zeros((held.element.size, 0))


def _loaded(holding: Holding, name: str, extra: Shapes) -> Part:
    part = holding.parts[name]
    if isinstance(part, TravellingElement):
        return _travelling(part, holding.at_stations(name), extra)
    held = holding.held(name, holding.reference)
    static = static_shapes(held)
    energy = energy_matrix(held, static)
    others = np.hstack([_rigid(part), held.still, shapes_under_loads(held), extra(held)])
    columns = np.hstack([static, others]) * equal_in_energy(energy, static, others)
    return _in_shapes(part, columns @ independent(energy, columns))


def _rigid(element: SuperElement) -> FloatArray:
    """(n, 6): the rigid motions of a free part; of one that is held none."""
    return np.zeros((element.size, 0)) if element.grounded else element.rigid_body_modes()


def _travelling(part: TravellingElement, stations: Sequence[Held], extra: Shapes) -> TravellingElement:
    """The same combinations of shapes at every station: they are smooth along the way.

    A free part's rigid motions come first: they strain nothing, and the stiffness of the rest is positive definite, and
    interpolated so that it stays so.
    """
    rigid = [_rigid(held.element) for held in stations]
    static = [static_shapes(held) for held in stations]
    others = [np.hstack([shapes_under_loads(held), extra(held)]) for held in stations]
    middle = len(stations) // 2
    energy = energy_matrix(stations[middle], static[middle])
    size = equal_in_energy(energy, static[middle], others[middle])
    shapes = [np.hstack(pair) * size for pair in zip(static, others, strict=True)]
    strained = apart_from(energy, rigid[middle], shapes[middle])
    bases = [np.hstack([first, np.hstack([first, rest]) @ strained]) for first, rest in zip(rigid, shapes, strict=True)]
    elements = tuple(_in_shapes(element, basis) for element, basis in zip(part.elements, bases, strict=True))
    if (products := part.products) is not None:
        products = np.einsum("iab,ijac,jcd->ijbd", bases, products, bases, optimize=True)
    contact = tuple(range(rigid[0].shape[1], bases[0].shape[1]))
    loaded = replace(part, elements=elements, products=products, contact=contact)
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
