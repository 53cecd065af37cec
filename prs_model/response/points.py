"""Nodes at which forces act and motions are read, in the axes of the output frame."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray
from ..errors import PrsError, UnknownNameError
from ..plugins import unknown

if TYPE_CHECKING:
    from ..synthesis import System


OUTPUT = "output"
"""The name of the end-reference point."""


@dataclass(frozen=True, eq=False)
class Point:
    """A node by its name, and its motion (6, n) on the system's coordinates: delta [m], epsilon [rad], along u, v, w.

    Its transpose spreads a wrench (force [N], moment [N m]) at the node over the coordinates. number: the same for one
    name at all poses, 1 for the output. position (3,) [m]: from the world's origin, along u, v, w.
    """

    name: str
    motion: FloatArray
    number: int
    position: FloatArray


def point(system: System, name: str | None = None) -> Point:
    """The end-reference point (``output``, or None), or a node ``body.node`` such as ``slider_1.hinge``.

    All nodes are read in the axes u, v, w of the output frame, so that a direction means the same everywhere. An
    interface with a node for each of its members is read as their mean.
    Raises UnknownNameError with the known bodies or nodes, PrsError for what is no such name.
    """
    axes = system.output_placement.rotation
    if name is None or name == OUTPUT:
        return Point(OUTPUT, system.output, 1, axes.T @ system.output_placement.translation)
    body, _, node = str(name).partition(".")
    if body not in system.elements:
        raise _unknown_body(system, body)
    if not node:
        raise PrsError(f"node: found '{name}', expected body.node, one of {', '.join(_nodes(system, body))}")
    ends = system.ends
    place = pin.SE3(axes, ends.position(str(name)))
    rows, motion = ends.motion(str(name), None, place)
    number = 2 + _names(system).index(str(name))
    return Point(str(name), np.asarray(motion @ system.expansion[rows]), number, axes.T @ place.translation)


def _names(system: System) -> list[str]:
    """Every node, and before those of an interface with a node for each member its own name."""
    names: dict[str, None] = {}
    for body in system.elements:
        for node in _nodes(system, body):
            parts = node.split(".")
            names |= dict.fromkeys(".".join(parts[:count]) for count in range(2, len(parts) + 1))
    return list(names)


def _nodes(system: System, body: str) -> list[str]:
    return [f"{body}.{node}" for node in system.elements[body].nodes]


def _unknown_body(system: System, name: str) -> UnknownNameError:
    """With the instances of a body that there are several of, or what is meant by a name that is almost right."""
    known = [OUTPUT, *system.elements]
    instances = [body for body in system.elements if system.stems.get(body) == name]
    if instances:
        return UnknownNameError("body", name, known, f"There are several: {', '.join(instances)}")
    return unknown("body", name, known)
