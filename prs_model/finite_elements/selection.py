"""From the words of an interface (a set, labels, a box, a cylinder, a plane) to the nodes it means."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import BoolArray, FloatArray, IntArray
from ..description.interface import Box, Cylinder, NodeId, Plane, Selection
from ..description.problems import did_you_mean
from ..errors import PartFileError
from .facets import area_weights

Mask = BoolArray

MOST_LISTED = 30  # labels in a message
LENGTHS = "lengths are in m in Python and on the command line, and in its own units in machine.yaml"
ENDS = ((0, 1.0), (1, -1.0))  # of bounds [low, high], and where their inside is
PLACES = ("box", "cylinder", "plane")
SLACK = 1e-6  # of the part's size: nodes this close to the face of a box count as on it
NO_AREA = 1e-14  # of the part's size squared: a weight that is round-off


class LabelledNodes(Protocol):
    """Nodes to select from: those of a finite-element model, or the retained ones of a reduced part."""

    @property
    def source(self) -> str: ...
    @property
    def coordinates(self) -> FloatArray: ...
    @property
    def rows(self) -> IntArray: ...
    @property
    def node_ids(self) -> NDArray[Any] | None: ...
    @property
    def node_sets(self) -> Mapping[str, IntArray]: ...
    @property
    def set_weights(self) -> Mapping[str, FloatArray]: ...
    @property
    def areas(self) -> FloatArray | None: ...


class SurfaceNodes(LabelledNodes, Protocol):
    """Nodes of which those on the outer surface are known as facets, as of a finite-element model."""

    @property
    def facets(self) -> IntArray | None: ...


def select(
    model: LabelledNodes, selection: Selection, *, shift: ArrayLike = (0.0, 0.0, 0.0), entry: str = "selection"
) -> tuple[IntArray, FloatArray]:
    """Node indices (m,) and weights (m,) that a selection means; several ways of naming them are intersected.

    Weights are nodal areas [m^2]: those of the selected set where it has them, else those of the outer surface; all are
    zero when no area is known. shift: how far boxes, cylinders and planes have moved [m]. Nodes without DOFs (clamped
    ones) are left out. Raises PartFileError naming `entry` when a set or label is unknown or nothing is left, with what
    each part of the selection found.
    """
    masks = dict(_masks(model, selection, np.asarray(shift, dtype=float), entry))
    if not masks:
        raise PartFileError(model.source, f"{entry}: {_no_words(model, entry.rpartition('.')[2])}")
    alive = np.any(model.rows >= 0, axis=1)
    chosen = np.flatnonzero(np.logical_and.reduce([alive, *masks.values()]))
    if not len(chosen):
        raise PartFileError(model.source, _nothing(model, masks, alive, entry))
    return chosen, _weights(model, selection, chosen)


def select_area(
    model: SurfaceNodes, selection: Selection, *, shift: ArrayLike = (0.0, 0.0, 0.0), entry: str = "selection"
) -> tuple[IntArray, FloatArray]:
    """Node indices (m,) and weights (m,) [m^2] of the area that a selection means, a smooth function of its `shift`.

    Facets of the outer surface whose nodes are all in what else the selection names are cut along the sides of its box
    and the ends of its cylinder, and w_i = int N_i dA over what is inside. The nodes are those with weight: they may
    stand outside the box, and a corner's weight may be negative (see `facets`). Without sides, facets or area it is
    `select`. Raises as that does.
    """
    moved = np.asarray(shift, dtype=float)
    normals, offsets = _sides(selection, moved)
    if not len(normals) or model.facets is None:
        return select(model, selection, shift=moved, entry=entry)
    named = [mask for _, mask in _masks(model, _without_sides(selection), moved, entry)]
    facets = model.facets[np.all([mask[model.facets].all(axis=1) for mask in named], axis=0)] if named else model.facets
    distances = model.coordinates @ normals.T - offsets
    distances[np.abs(distances) <= SLACK * _size(model)] = 0.0
    weights = area_weights(model.coordinates, facets, distances)
    weights[np.all(model.rows < 0, axis=1)] = 0.0
    chosen = np.flatnonzero(np.abs(weights) > NO_AREA * _size(model) ** 2)
    return (chosen, weights[chosen]) if len(chosen) else select(model, selection, shift=moved, entry=entry)


def listed_nodes(labels: Iterable[object]) -> str:
    """Labels of nodes for a sentence; of very many, how many and which."""
    known = [str(label) for label in labels]
    return ", ".join(known) if len(known) <= MOST_LISTED else f"{len(known)} of them, {known[0]} to {known[-1]}"


def _no_words(model: LabelledNodes, name: str) -> str:
    nodes = [] if model.node_ids is None else [str(label) for label in model.node_ids]
    meant = "{set: %s}" if name in model.node_sets else "{node: %s}" if name in nodes else ""
    return "no nodes named, expected one of set, nodes, node, box, cylinder, plane" + (
        f"; did you mean {meant % name}?" if meant else ""
    )


def unknown_set(model: LabelledNodes, name: str, entry: str) -> str:
    """The sentence for a node set that the part does not have."""
    known = list(model.node_sets)
    nodes = [] if model.node_ids is None else [str(label) for label in model.node_ids]
    if name in nodes:
        return f"{entry}: found node set '{name}', which is a node of the part; did you mean {{node: {name}}}?"
    if known:
        return f"{entry}: found node set '{name}', expected one of {', '.join(known)}{did_you_mean(name, known)}"
    instead = f"; its nodes are {listed_nodes(nodes)}{did_you_mean(name, nodes)}" if nodes else ""
    return f"{entry}: found node set '{name}', and the part has none{instead}"


def _masks(model: LabelledNodes, selection: Selection, shift: FloatArray, entry: str) -> Iterable[tuple[str, Mask]]:
    if selection.set is not None:
        if selection.set not in model.node_sets:
            raise PartFileError(model.source, unknown_set(model, selection.set, f"{entry}.set"))
        yield f"set '{selection.set}'", _mask_of(model, model.node_sets[selection.set])
    if selection.nodes is not None:
        yield "nodes", _mask_of(model, _labelled(model, selection.nodes, f"{entry}.nodes"))
    slack = SLACK * _size(model)
    points = model.coordinates - shift
    if selection.box is not None:
        yield f"box ({_limits(selection.box)})", _in_box(points, selection.box, slack)
    if selection.cylinder is not None:
        yield "cylinder", _on_cylinder(points, selection.cylinder, slack)
    if selection.plane is not None:
        yield "plane", _on_plane(points, selection.plane)


def _size(model: LabelledNodes) -> float:
    return float(np.ptp(model.coordinates, axis=0).max())


def _sides(selection: Selection, shift: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Planes that bound a selection, inside of which n . x >= c: normals n (h, 3) and offsets c (h,) [m]."""
    slabs = []
    if selection.box is not None:
        limits = (selection.box.x, selection.box.y, selection.box.z)
        slabs += [(axis, shift @ axis, each) for axis, each in zip(np.eye(3), limits, strict=True)]
    if selection.cylinder is not None:
        axis = np.array(selection.cylinder.axis, dtype=float) / np.linalg.norm(selection.cylinder.axis)
        start = np.array(selection.cylinder.point, dtype=float) + shift
        slabs.append((axis, start @ axis, selection.cylinder.length))
    sides = [(sign * axis, sign * (at + each[end])) for axis, at, each in slabs if each for end, sign in ENDS]
    return np.array([normal for normal, _ in sides]).reshape(-1, 3), np.array([offset for _, offset in sides])


def _without_sides(selection: Selection) -> Selection:
    endless = None if selection.cylinder is None else selection.cylinder.model_copy(update={"length": None})
    return selection.model_copy(update={"box": None, "cylinder": endless})


def _mask_of(model: LabelledNodes, nodes: IntArray) -> Mask:
    mask = np.zeros(len(model.coordinates), dtype=bool)
    mask[nodes] = True
    return mask


def _labelled(model: LabelledNodes, labels: tuple[NodeId, ...], entry: str) -> IntArray:
    if model.node_ids is None:
        raise PartFileError(
            model.source, f"{entry}: its nodes have no labels that are read; name a set, a box or a cylinder instead"
        )
    place = {str(label): index for index, label in enumerate(model.node_ids)}
    missing = [label for label in labels if str(label) not in place]
    if missing:
        known = [str(label) for label in model.node_ids]
        near = did_you_mean(str(missing[0]), known) if len(known) <= MOST_LISTED else ""
        expected = f"expected a node of the part ({listed_nodes(known)}){near}"
        raise PartFileError(model.source, f"{entry}: found node '{missing[0]}', {expected}")
    return np.array([place[str(label)] for label in labels], dtype=np.int64)


def _limits(box: Box) -> str:
    given = ((axis, getattr(box, axis)) for axis in "xyz")
    return ", ".join(f"{axis} {limits[0]:g} to {limits[1]:g} m" for axis, limits in given if limits is not None)


def _in_box(points: FloatArray, box: Box, slack: float) -> Mask:
    inside = np.ones(len(points), dtype=bool)
    for axis, limits in enumerate((box.x, box.y, box.z)):
        if limits is not None:
            inside &= (points[:, axis] >= limits[0] - slack) & (points[:, axis] <= limits[1] + slack)
    return inside


def _on_cylinder(points: FloatArray, cylinder: Cylinder, slack: float) -> Mask:
    axis = np.array(cylinder.axis, dtype=float) / np.linalg.norm(cylinder.axis)
    arms = points - np.array(cylinder.point, dtype=float)
    along = arms @ axis
    radius = np.linalg.norm(arms - np.outer(along, axis), axis=1)
    on = np.abs(radius - cylinder.radius) <= cylinder.tolerance
    if cylinder.length is not None:
        on &= (along >= cylinder.length[0] - slack) & (along <= cylinder.length[1] + slack)
    return np.asarray(on)


def _on_plane(points: FloatArray, plane: Plane) -> Mask:
    normal = np.array(plane.normal, dtype=float) / np.linalg.norm(plane.normal)
    distance = (points - np.array(plane.point, dtype=float)) @ normal
    return np.asarray(np.abs(distance) <= plane.tolerance)


def _weights(model: LabelledNodes, selection: Selection, chosen: IntArray) -> FloatArray:
    weights = np.zeros(len(model.coordinates)) if model.areas is None else model.areas.copy()
    if selection.set is not None and selection.set in model.set_weights:
        weights[model.node_sets[selection.set]] = model.set_weights[selection.set]
    return np.asarray(weights[chosen], dtype=float)


def _nothing(model: LabelledNodes, masks: dict[str, Mask], alive: Mask, entry: str) -> str:
    found = ", ".join(f"{name} {np.count_nonzero(mask)}" for name, mask in masks.items())
    if np.any(np.logical_and.reduce(list(masks.values()))):
        return f"{entry}: all its nodes are clamped ({found}); clamp another set, or hold the interface elsewhere"
    base = next(iter(masks.values()))
    points = model.coordinates[base] if len(masks) > 1 and np.any(base) else model.coordinates
    what = next(iter(masks)) if len(masks) > 1 and np.any(base) else "the part"
    where = f"no node is in all of: {found}; {what} reaches {reach(points)}"
    return f"{entry}: {where}" + (f"; {LENGTHS}" if any(name.startswith(PLACES) for name in masks) else "")


def reach(points: FloatArray) -> str:
    """From where to where points (n, 3) [m] reach, for a sentence."""
    return f"from {point(points.min(axis=0))} to {point(points.max(axis=0))} m"


def point(place: FloatArray) -> str:
    """``(0.1, 0, 2)``."""
    return "(" + ", ".join(f"{x:.4g}" for x in place) + ")"
