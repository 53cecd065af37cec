"""A super-element as Nastran numbers it: grid points with output frames and components, scalar points for modes."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from prs_model.arrays import FloatArray, IntArray
from prs_model.description.units import Units
from prs_model.errors import PartFileError
from prs_model.part_files import MODE
from prs_model.part_files.labelled import LENGTH, in_file_units
from prs_model.reduction import SuperElement
from prs_model.reduction.super_element import AXES

LARGEST = 99_999_999  # an integer of eight digits
UNIT = 1e-9


@dataclass(frozen=True, eq=False)
class Points:
    """Grids (k,) with coordinates (k, 3) in the file's length and frames (k, 3, 3), columns in body axes; then rows.

    points, components: (n,) of each row of stiffness and mass (n, n), by grid and component, modes (MODE) last.
    names: of points that are not called by their number.
    """

    grids: tuple[int, ...]
    coordinates: FloatArray
    frames: FloatArray
    points: tuple[int, ...]
    components: IntArray
    stiffness: FloatArray
    mass: FloatArray
    names: dict[int, str]


def points_of(element: SuperElement, path: Path, units: Units) -> Points:
    """The element in `units`. path: of the file to write, for messages.

    Raises PartFileError unless each coordinate is a mode, or the motion of one node along or about one axis.
    """
    physical = element.size - element.n_modes
    columns = _columns(element, physical, path)
    components = np.full(element.size, MODE)
    frames = np.array([_frame(element, j, columns[j], components, path) for j in range(len(element.nodes))])
    order = [row for own in columns for row in sorted(own, key=lambda row: int(components[row]))]
    order += list(range(physical, element.size))
    grids, modes, names = _numbers(element, physical)
    points = [grid for grid, own in zip(grids, columns, strict=True) for _ in own]
    square = np.ix_(order, order)
    stiffness, mass = in_file_units(element.stiffness[square], element.mass[square], components[order], units)
    return Points(
        grids=tuple(grids),
        coordinates=element.positions / LENGTH.factor(units),
        frames=frames,
        points=(*points, *modes),
        components=components[order],
        stiffness=stiffness,
        mass=mass,
        names=names,
    )


def _columns(element: SuperElement, physical: int, path: Path) -> list[list[int]]:
    """The coordinates of each node."""
    moves = np.any(element.motions != 0.0, axis=1)
    owners = np.count_nonzero(moves[:, :physical], axis=0)
    if np.any(owners != 1) or np.any(moves[:, physical:]):
        at = int(np.argmax(np.concatenate([owners != 1, np.any(moves[:, physical:], axis=0)])))
        moved = ", ".join(np.array(element.nodes)[moves[:, at]]) or "no node"
        raise PartFileError(
            path,
            f"coordinate {element.labels[at]} moves {moved}, expected one node, or a trailing mode: Nastran's points "
            "cannot hold such an element (.npz can); reduce the part to interfaces first",
        )
    columns = [np.flatnonzero(row[:physical]).tolist() for row in moves]
    without = [node for node, own in zip(element.nodes, columns, strict=True) if not own]
    if without:
        raise PartFileError(
            path, f"node {without[0]} has no coordinates of its own, so that no row can be written for it"
        )
    return columns


def _frame(element: SuperElement, node: int, own: list[int], components: IntArray, path: Path) -> FloatArray:
    """(3, 3) the axes that a node's coordinates are along; sets their components."""
    shown = element.motions[node][:, own].reshape(2, 3, -1)  # translations and rotations
    turns = np.linalg.norm(shown[0], axis=0) < np.linalg.norm(shown[1], axis=0)
    axes = np.where(turns, shown[1], shown[0])
    where = f"node {element.nodes[node]}"
    if np.any(np.where(turns, shown[0], shown[1])) or np.any(np.abs(np.linalg.norm(axes, axis=0) - 1.0) > UNIT):
        raise PartFileError(path, f"{where}: a coordinate is no unit motion along or about one axis")
    frame = _axes(axes, turns, [element.labels[row] for row in own])
    if frame is None:
        raise PartFileError(path, f"{where} has turned axes, but not all three of them")
    along = frame.T @ axes
    place = np.argmax(along, axis=0)
    if np.max(np.abs(along - np.eye(3)[:, place])) > UNIT or len(
        set(zip(turns.tolist(), place.tolist(), strict=True))
    ) != len(own):
        raise PartFileError(path, f"{where}: its coordinates are not along the axes of one right-handed frame")
    components[own] = place + 3 * turns
    return frame


def _axes(axes: FloatArray, turns: FloatArray, labels: list[str]) -> FloatArray | None:
    """The three translations, or rotations, in the order that their labels say; else the body's axes, if they fit."""
    for wanted in (False, True):
        some = np.flatnonzero(turns == wanted)
        if len(some) == 3:
            endings = [labels[index].rsplit(".", 1)[-1] for index in some]
            known = all(ending in AXES for ending in endings)
            frame = axes[:, some[np.argsort([AXES.index(ending) for ending in endings])] if known else some]
            if np.linalg.det(frame) > 0.0:
                return np.where(np.abs(frame - np.eye(3)) < UNIT, np.eye(3), frame)
    fit = np.isclose(axes, 0.0, atol=UNIT, rtol=0.0) | np.isclose(axes, 1.0, atol=UNIT, rtol=0.0)
    return np.eye(3) if np.all(fit) else None


def _numbers(element: SuperElement, physical: int) -> tuple[list[int], list[int], dict[int, str]]:
    """Numbers of nodes and of modes: their own where they are called by one, else free ones; and the names of these."""
    modes = [label.removeprefix("mode ") for label in element.labels[physical:]]
    called = [*element.nodes, *modes]
    numbers = [int(name) if re.fullmatch(r"[1-9]\d{0,7}", name) else 0 for name in called]
    taken: set[int] = set()
    for index, number in enumerate(numbers):
        numbers[index] = 0 if number in taken else number
        taken.add(number)
    free = (number for number in range(1, LARGEST + 1) if number not in taken)
    numbers = [number or next(free) for number in numbers]
    names = {number: name for number, name in zip(numbers, called, strict=True) if str(number) != name}
    return numbers[: len(element.nodes)], numbers[len(element.nodes) :], names


def components_of(points: Points) -> list[tuple[int, str]]:
    """Each point with its components in one word, such as ``(3, "123456")``, or ``"0"`` for a scalar point."""
    words: dict[int, str] = {}
    for point, component in zip(points.points, points.components.tolist(), strict=True):
        words[point] = words.get(point, "") + str(component + 1)
    return list(words.items())


def scalars_of(points: Points) -> list[int]:
    """Scalar points, in the order of their rows."""
    return [point for point, component in zip(points.points, points.components, strict=True) if component == MODE]


def pairs(words: Iterable[tuple[int, str]]) -> list[str]:
    """Fields of an entry that lists points and components, such as EXTRN."""
    return [field for point, components in words for field in (str(point), components)]
