"""Parts that come already reduced: their retained nodes take the names of the body's interfaces."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from ..description.problems import did_you_mean
from ..description.schema import Interface
from ..errors import PartFileError
from .super_element import SuperElement


def named_by_interfaces(element: SuperElement, interfaces: Mapping[str, Interface], source: str) -> SuperElement:
    """Rename the node that each interface's `node` (default: its own name) refers to; labels follow.

    Raises PartFileError for a node the part does not have, one named twice, or entries that need a full model.
    """
    new_names: dict[str, str] = {}
    for name, interface in interfaces.items():
        entry = f"interfaces.{name}"
        _only_names_a_node(interface, entry, source)
        node = name if interface.node is None else str(interface.node)
        if node not in element.nodes:
            raise PartFileError(source, f"{entry}.node: {_unknown(node, element.nodes)}")
        if node in new_names:
            raise PartFileError(source, f"{entry}.node: node '{node}' is interface '{new_names[node]}' already")
        new_names[node] = name
    nodes = tuple(new_names.get(node, node) for node in element.nodes)
    if len(set(nodes)) < len(nodes):
        twice = next(node for node in nodes if nodes.count(node) > 1)
        raise PartFileError(source, f"interface '{twice}' has the name of another retained node; give it another name")
    labels = tuple(_renamed(label, new_names) for label in element.labels)
    return replace(element, nodes=nodes, labels=labels)


def _only_names_a_node(interface: Interface, entry: str, source: str) -> None:
    full_only = {
        "set, nodes, box or cylinder": not interface.is_empty(),
        "members": bool(interface.members),
        "at": interface.at is not None,
        "travel": interface.travel is not None,
    }
    for what, given in full_only.items():
        if given:
            raise PartFileError(
                source, f"{entry}: found '{what}', but the part is already reduced: name one of its nodes with 'node'"
            )


def _unknown(node: str, known: tuple[str, ...]) -> str:
    return f"found '{node}', expected a node of the part ({', '.join(known)}){did_you_mean(node, known)}"


def _renamed(label: str, names: Mapping[str, str]) -> str:
    node, dot, axis = label.rpartition(".")
    return f"{names[node]}.{axis}" if dot and node in names else label
