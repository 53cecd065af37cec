"""The interfaces of a body as ties between finite-element nodes and condensation nodes."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from ..arrays import FloatArray, IntArray
from ..description.interface import Coupling, Interface, Member, Point, Selection
from ..description.problems import did_you_mean, listed
from ..errors import PartFileError
from ..finite_elements import FiniteElementModel
from ..finite_elements.selection import listed_nodes, select, select_area
from .coupling import Tie
from .recipe import Settings

STILL = np.zeros(3)


def as_meant(
    interfaces: Mapping[str, Interface], sets: Sequence[str], nodes: Sequence[str], source: str
) -> dict[str, Interface]:
    """Interfaces that were named by one word as what it is: a node set of the part, or else its node of that name.

    Raises PartFileError for a word that is neither.
    """
    meant = {}
    for name, interface in interfaces.items():
        if (word := interface.named) is not None:
            if word not in sets and word not in nodes:
                known = f"a node set ({listed(sets)}) nor a node ({listed_nodes(nodes) if nodes else 'none'})"
                message = f"found '{word}', which is neither {known}{did_you_mean(word, [*sets, *nodes])}"
                raise PartFileError(source, f"interfaces.{name}: {message}")
            interface = interface.model_copy(update={"named": None, "set" if word in sets else "node": word})
        meant[name] = interface
    return meant


def interface_ties(
    model: FiniteElementModel,
    interfaces: Mapping[str, Interface],
    settings: Settings,
    shift: FloatArray = STILL,
) -> list[Tie]:
    """One tie per condensation node, in the order of the interfaces; travelling ones moved by `shift` (3,) [m].

    An interface becomes the node ``<interface>``, or, tied at the interface, one node ``<interface>.<member>`` for each
    of its members. Rigid ones hold the nodes inside a box, averaged ones the area inside it. A node stands at `at`, by
    default in the weighted centre of what it holds.
    """
    ties: list[Tie] = []
    labels = [] if model.node_ids is None else [str(label) for label in model.node_ids]
    for name, interface in as_meant(interfaces, list(model.node_sets), labels, model.source).items():
        moved = STILL if interface.travel is None else shift
        ties.extend(_ties(model, name, interface, settings, moved))
    return ties


def _ties(
    model: FiniteElementModel, name: str, interface: Interface, settings: Settings, shift: FloatArray
) -> Iterator[Tie]:
    entry, coupling = f"interfaces.{name}", settings.coupling_of(interface)
    if interface.node is not None:
        interface = interface.model_copy(update={"node": None, "nodes": (interface.node,)})
    parts: tuple[Selection, ...] = interface.members or (interface,)
    choose = select_area if coupling == "averaged" else select
    chosen = [choose(model, part.alone(), shift=shift, entry=_entry(entry, part)) for part in parts]
    if settings.tie_of(interface) == "interface" and interface.members:
        for member, each in zip(interface.members, chosen, strict=True):
            indices, weights = _union([each])
            position = _position(model, member.at, shift, indices, weights)
            yield _tie(f"{name}.{member.name}", indices, weights, position, coupling)
    else:
        indices, weights = _union(chosen)
        yield _tie(name, indices, weights, _position(model, interface.at, shift, indices, weights), coupling)


def _tie(node: str, indices: IntArray, weights: FloatArray, position: FloatArray, coupling: Coupling) -> Tie:
    """One node alone has no motions to average: it is held rigidly, whatever the coupling."""
    return Tie(node, indices, weights, position, "rigid" if len(indices) == 1 else coupling)


def _entry(entry: str, part: Selection) -> str:
    return f"{entry}.members[{part.name}]" if isinstance(part, Member) else entry


def _union(chosen: list[tuple[IntArray, FloatArray]]) -> tuple[IntArray, FloatArray]:
    """All nodes once, with the sum of their areas; with equal weights when the nodes of a member have no area."""
    indices, place = np.unique(np.concatenate([nodes for nodes, _ in chosen]), return_inverse=True)
    if all(np.any(areas > 0.0) for _, areas in chosen):
        areas = np.concatenate([areas for _, areas in chosen])
        return indices, np.asarray(np.bincount(place, weights=areas), dtype=float)
    return indices, np.ones(len(indices))


def _position(
    model: FiniteElementModel, at: Point | None, shift: FloatArray, indices: IntArray, weights: FloatArray
) -> FloatArray:
    if at is not None:
        return np.array(at, dtype=float) + shift
    return np.asarray(np.average(model.coordinates[indices], axis=0, weights=weights))
