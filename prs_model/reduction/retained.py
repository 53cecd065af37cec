"""Interfaces of parts that come already reduced: one retained node, or several tied to a new one."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import permutations

import numpy as np

from ..arrays import FloatArray, IntArray
from ..description.interface import Coupling, Interface, Selection
from ..description.problems import did_you_mean
from ..errors import PartFileError
from ..finite_elements.rigid_motion import transfer
from ..finite_elements.selection import select
from .interfaces import as_meant
from .recipe import Settings
from .super_element import AXES, SuperElement, node_labels, present_motions
from .surprising_ties import warn_of_distance


def at_interfaces(
    element: SuperElement, interfaces: Mapping[str, Interface], settings: Settings, source: str
) -> SuperElement:
    """The element with a node for every interface; retained nodes that are not tied keep their labels.

    An interface is one node of the part (`node`, default: its own name), or a selection of them: tied rigidly to a new
    node, whose six coordinates replace theirs, or averaged, which adds a node and no coordinate. Raises PartFileError
    for a node the part does not have, one used twice, or an interface that cannot move in six ways.
    """
    interfaces = as_meant(interfaces, list(element.node_sets), element.nodes, source)
    names: dict[str, str] = {}
    for name, interface in interfaces.items():
        if interface.travel is not None:
            raise PartFileError(
                source, f"interfaces.{name}.travel: a part that is already reduced cannot be travelled over"
            )
        if interface.is_empty() and not interface.members:
            node = _one_node(element, name, interface, names, source)
            names[node] = name
    ties = [tie for name, each in interfaces.items() for tie in _ties(element, name, each, settings, source)]
    _check(element, ties, names, source)
    for tie in sorted(ties, key=lambda tie: tie.coupling == "rigid"):  # a rigid tie takes nodes that others average
        element = _rigid(element, tie, source) if tie.coupling == "rigid" else _averaged(element, tie)
    return _renamed(replace(element, node_sets={}), names, source) if interfaces else element


@dataclass(frozen=True, eq=False)
class _Tie:
    """Retained nodes, by name, that act through a new one at `position` (3,) [m]."""

    node: str
    nodes: tuple[str, ...]
    position: FloatArray
    coupling: Coupling

    def indices(self, element: SuperElement) -> IntArray:
        return np.array([element.node(node) for node in self.nodes])


@dataclass(frozen=True, eq=False)
class _RetainedNodes:
    """The element's nodes as `select` wants them."""

    source: str
    coordinates: FloatArray
    rows: IntArray
    node_ids: IntArray
    node_sets: Mapping[str, IntArray]
    set_weights: Mapping[str, FloatArray] = field(default_factory=dict)
    areas: FloatArray | None = None


def _one_node(element: SuperElement, name: str, interface: Interface, names: Mapping[str, str], source: str) -> str:
    entry, node = f"interfaces.{name}.node", name if interface.node is None else str(interface.node)
    if interface.at is not None:
        raise PartFileError(source, f"interfaces.{name}.at: a retained node stands where the file says; remove 'at'")
    if node not in element.nodes:
        known = list(element.nodes)
        found = f"found '{node}', expected a node of the part ({', '.join(known)}){did_you_mean(node, known)}"
        raise PartFileError(source, f"{entry}: {found}")
    if node in names:
        raise PartFileError(source, f"{entry}: node '{node}' is interface '{names[node]}' already")
    motion = element.motions[element.node(node)]
    if np.linalg.matrix_rank(motion) < 6:
        there = [axis for axis, row in zip(AXES, motion, strict=True) if np.any(row)]
        raise PartFileError(
            source,
            f"{entry}: node '{node}' has {', '.join(there) or 'no motion'} only, and a joint takes hold of six "
            "motions; name three or more nodes as 'nodes', or export its rotations",
        )
    return node


def _ties(element: SuperElement, name: str, interface: Interface, settings: Settings, source: str) -> Iterator[_Tie]:
    entry, coupling = f"interfaces.{name}", settings.coupling_of(interface)
    sets = {key: np.array([element.node(each) for each in nodes]) for key, nodes in element.node_sets.items()}
    rows = np.where(np.any(element.motions != 0.0, axis=2), 0, -1)
    nodes = _RetainedNodes(source, element.positions, rows, np.array(element.nodes), sets)

    def chosen(part: Selection, entry: str) -> IntArray:
        return select(nodes, part.alone(), entry=entry)[0]

    def tie(node: str, at: tuple[float, ...] | None, indices: IntArray) -> _Tie:
        tied = element.positions[indices]
        position = tied.mean(axis=0) if at is None else np.array(at, dtype=float)
        warn_of_distance(source, node, position, tied, element.positions)
        named = tuple(element.nodes[index] for index in indices)
        return _Tie(node, named, position, "rigid" if len(indices) == 1 else coupling)

    groups = [chosen(each, f"{entry}.members[{each.name}]") for each in interface.members]
    if interface.members and settings.tie_of(interface) == "interface":
        for member, indices in zip(interface.members, groups, strict=True):
            yield tie(f"{name}.{member.name}", member.at, indices)
    elif interface.members:
        yield tie(name, interface.at, np.unique(np.concatenate(groups)))
    elif not interface.is_empty():
        yield tie(name, interface.at, chosen(interface, entry))


def _check(element: SuperElement, ties: Sequence[_Tie], names: Mapping[str, str], source: str) -> None:
    """As `coupling.check_ties` does for full models. Raises PartFileError."""
    for tie in ties:
        taken = [node for node in tie.nodes if node in names]
        if taken and tie.coupling == "rigid":
            message = f"node '{taken[0]}' belongs to interface {names[taken[0]]} already"
            raise PartFileError(source, f"interfaces.{tie.node}: {message}")
        if not _can_turn(element, tie):
            message = "lie on one line and cannot take up a rotation about it; select nodes of a surface"
            raise PartFileError(source, f"interfaces.{tie.node}: its {len(tie.nodes)} nodes {message}")
    for one, other in permutations(ties, 2):
        shared = [node for node in one.nodes if node in other.nodes]
        if shared and one.coupling == other.coupling == "rigid":
            message = (
                f"share node '{shared[0]}', which cannot follow two rigid nodes at once; make the selections apart"
            )
            raise PartFileError(source, f"interfaces {one.node} and {other.node} {message}")
        if (
            one.coupling == "averaged"
            and len(shared) == len(one.nodes)
            and (other.coupling == "rigid" or len(shared) == len(other.nodes))
        ):
            message = f"is averaged over nodes that {other.node} moves already, so it repeats {other.node}"
            raise PartFileError(source, f"interface {one.node} {message}; use one interface for both")


def _can_turn(element: SuperElement, tie: _Tie) -> bool:
    """Whether its nodes' motions (averaged: translations) tell six rigid motions apart."""
    indices, axes = tie.indices(element), 3 if tie.coupling == "averaged" else 6
    arms = element.positions[indices] - element.positions[indices].mean(axis=0)
    wanted = transfer(arms)[:, :axes]
    wanted[..., 3:] /= np.linalg.norm(arms, axis=1).max() or 1.0
    rows = present_motions(element.motions[indices, :axes], wanted)[1]
    return bool(np.linalg.matrix_rank(rows, tol=1e-6) == 6)


def _rigid(element: SuperElement, tie: _Tie, source: str) -> SuperElement:
    """u = P u' with the tied nodes' coordinates replaced by the six of one node: u_j = X(r_j - r) q, eq. (4)-(6)."""
    indices = tie.indices(element)
    rows, wanted = present_motions(element.motions[indices], transfer(element.positions[indices] - tie.position))
    own = np.flatnonzero(np.any(rows != 0.0, axis=0))
    if len(own) != np.linalg.matrix_rank(rows):
        raise PartFileError(
            source,
            f"interfaces.{tie.node}: the coordinates of its nodes are not their motions; use 'coupling: averaged'",
        )
    kept = np.setdiff1d(np.arange(element.size), own)
    projection = np.zeros((element.size, 6 + len(kept)))
    projection[own, :6] = np.linalg.lstsq(rows[:, own], wanted, rcond=None)[0]
    projection[kept, 6 + np.arange(len(kept))] = 1.0
    others = np.setdiff1d(np.arange(len(element.nodes)), indices)
    return replace(
        element,
        stiffness=projection.T @ element.stiffness @ projection,
        mass=projection.T @ element.mass @ projection,
        nodes=(tie.node, *(element.nodes[index] for index in others)),
        positions=np.vstack([tie.position, element.positions[others]]),
        motions=np.concatenate([np.eye(6, 6 + len(kept))[None], element.motions[others] @ projection]),
        labels=(*node_labels(tie.node), *(element.labels[index] for index in kept)),
        node_sets={},
        surface=None if element.surface is None else element.surface.through(projection),
    )


def _averaged(element: SuperElement, tie: _Tie) -> SuperElement:
    """A node that moves as its nodes do on average: U = (X^T X)^-1 X^T u over the translations that they have."""
    indices = tie.indices(element)
    arms = transfer(element.positions[indices] - tie.position)[:, :3]
    motions, arms = present_motions(element.motions[indices, :3], arms)
    return replace(
        element,
        nodes=(tie.node, *element.nodes),
        positions=np.vstack([tie.position, element.positions]),
        motions=np.concatenate([np.linalg.lstsq(arms, motions, rcond=None)[0][None], element.motions]),
        node_sets={},
    )


def _renamed(element: SuperElement, names: Mapping[str, str], source: str) -> SuperElement:
    nodes = tuple(names.get(node, node) for node in element.nodes)
    if len(set(nodes)) < len(nodes):
        twice = next(node for node in nodes if nodes.count(node) > 1)
        raise PartFileError(source, f"interface '{twice}' has the name of another retained node; give it another name")
    return replace(element, nodes=nodes, labels=tuple(_label(label, names) for label in element.labels))


def _label(label: str, names: Mapping[str, str]) -> str:
    node, dot, axis = label.rpartition(".")
    return f"{names[node]}.{axis}" if dot and node in names else label
