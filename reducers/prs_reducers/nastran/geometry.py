"""GRID points and coordinate systems of bulk data, resolved to the basic system."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from prs_model.arrays import FloatArray
from prs_model.errors import PartFileError
from prs_model.part_files import NodeTable

from .cards import BLANK, Card

T = TypeVar("T")

SYSTEMS = {"CORD2R": 1, "CORD2C": 2, "CORD2S": 3}


@dataclass(frozen=True)
class Grid:
    """A grid point: where it stands in system `cp`, and the system `cd` of its motions."""

    cp: int
    place: tuple[float, float, float]
    cd: int


@dataclass(frozen=True)
class System:
    """A coordinate system by three points in system `parent`: origin, one on its z axis, one in its xz plane.

    kind: 1 rectangular, 2 cylindrical (r, theta [deg], z), 3 spherical (r, theta [deg] from z, phi [deg]).
    """

    kind: int
    parent: int
    points: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True, eq=False)
class _Placed:
    kind: int
    origin: FloatArray
    axes: FloatArray


def grids_of(cards: Iterable[Card]) -> dict[int, Grid]:
    """Grid points by number. Raises PartFileError for one that stands there twice and differs."""
    grids: dict[int, Grid] = {}
    for card in cards:
        if card.name == "GRDSET":
            raise card.wrong("defaults of GRID entries are not supported: write them into the GRID entries")
        if card.name == "GRID":
            x, y, z = (card.real(i, 0.0) for i in (2, 3, 4))
            _put(grids, card, Grid(card.integer(1, 0), (x, y, z), card.integer(5, 0)))
    return grids


def systems_of(cards: Iterable[Card]) -> dict[int, System]:
    """Coordinate systems by number. Raises PartFileError for one that stands there twice and differs."""
    systems: dict[int, System] = {}
    for card in cards:
        if card.name in SYSTEMS:
            at = [card.real(i) for i in range(2, 11)]
            points = tuple((at[i], at[i + 1], at[i + 2]) for i in (0, 3, 6))
            _put(systems, card, System(SYSTEMS[card.name], card.integer(1, 0), points))
    return systems


def scalar_points(cards: Iterable[Card]) -> frozenset[int]:
    """Scalar points of ``SPOINT, 1, 2, 3`` and ``SPOINT, 1, THRU, 3``. Raises PartFileError."""
    found: set[int] = set()
    for card in cards:
        if card.name == "SPOINT":
            is_range = card.text(1).upper() == "THRU"
            filled = [index for index, text in enumerate(card.fields) if text != BLANK]
            found.update(
                points_between(card, card.integer(0), card.integer(2)) if is_range else map(card.integer, filled)
            )
    return frozenset(found)


def points_between(card: Card, first: int, last: int) -> range:
    """Points of ``first, THRU, last``. Raises PartFileError."""
    if not 0 < first <= last < first + 10**6:
        raise card.wrong(f"found {first} THRU {last}, expected a rising range")
    return range(first, last + 1)


def check_points(
    source: Path, rows: Iterable[tuple[int, int]], grids: Collection[int], scalars: Collection[int] | None
) -> None:
    """Raises PartFileError for a row of a grid point without a component, or of a scalar point with one.

    scalars: None where the files do not list them.
    """
    for point, component in rows:
        if component == 0 and (point in grids or (scalars is not None and point not in scalars)):
            kind = "SPOINT"
        elif component and scalars is not None and point in scalars:
            kind = "GRID"
        else:
            continue
        raise PartFileError(source, f"row {point}.{component} belongs to no {kind} entry: a line is missing or damaged")


def _put(found: dict[int, T], card: Card, entry: T) -> None:
    identity = card.integer(0)
    if found.setdefault(identity, entry) != entry:
        raise card.wrong(f"{identity} stands there twice, with different data")


def node_table(
    source: Path, grids: Mapping[int, Grid], systems: Mapping[int, System], names: Mapping[int, str] | None = None
) -> NodeTable:
    """Grid points in the basic system, with the axes of their motions there (of cylinders and spheres, at their place).

    names: of points that have one beside their number. Raises PartFileError for a system that is missing or degenerate.
    """
    placed = {0: _Placed(1, np.zeros(3), np.eye(3))}
    for number in systems:
        _place(number, systems, placed, (), source)
    for each in grids.values():
        for number in (each.cp, each.cd):
            if number not in placed:
                raise PartFileError(
                    source, f"coordinate system {number} is not among its CORD2R, CORD2C and CORD2S entries"
                )
    coordinates = [_point(placed[each.cp], each.place) for each in grids.values()]
    frames = [_axes(placed[each.cd], at) for each, at in zip(grids.values(), coordinates, strict=True)]
    return NodeTable(
        source=source,
        labels=np.array([(names or {}).get(number, str(number)) for number in grids], dtype=str),
        coordinates=np.reshape(coordinates, (-1, 3)),
        frames=np.reshape(frames, (-1, 3, 3)),
    )


def _place(
    number: int, systems: Mapping[int, System], placed: dict[int, _Placed], below: tuple[int, ...], source: Path
) -> _Placed:
    if number in placed:
        return placed[number]
    if number in below or number not in systems:
        why = "refers to itself" if number in below else "is not among its CORD2R, CORD2C and CORD2S entries"
        raise PartFileError(source, f"coordinate system {number} {why}")
    system = systems[number]
    parent = _place(system.parent, systems, placed, (*below, number), source)
    origin, above, aside = (_point(parent, point) for point in system.points)
    z, x = above - origin, aside - origin
    y = np.cross(z, x)
    if np.linalg.norm(y) <= 1e-10 * np.linalg.norm(z) * np.linalg.norm(x):
        raise PartFileError(source, f"coordinate system {number}: its three points lie on one line")
    axes = np.column_stack([np.cross(y, z), y, z])
    placed[number] = _Placed(system.kind, origin, axes / np.linalg.norm(axes, axis=0))
    return placed[number]


def _point(system: _Placed, place: Iterable[float]) -> FloatArray:
    """(3,) in the basic system, from coordinates in `system`."""
    a, b, c = place
    local = np.array([a, b, c])
    if system.kind == 2:
        local = np.array([a * np.cos(np.radians(b)), a * np.sin(np.radians(b)), c])
    elif system.kind == 3:
        theta, phi = np.radians([b, c])
        local = a * np.array([np.sin(theta) * np.cos(phi), np.sin(theta) * np.sin(phi), np.cos(theta)])
    return np.asarray(system.origin + system.axes @ local)


def _axes(system: _Placed, at: FloatArray) -> FloatArray:
    """(3, 3): columns are the axes of motions at a point of the basic system."""
    x, y, z = system.axes.T @ (at - system.origin)
    if system.kind == 1:
        return system.axes
    turn = np.arctan2(y, x)
    radial, around = np.array([np.cos(turn), np.sin(turn), 0.0]), np.array([-np.sin(turn), np.cos(turn), 0.0])
    if system.kind == 2:
        local = np.column_stack([radial, around, [0.0, 0.0, 1.0]])
    else:
        down = np.arctan2(np.hypot(x, y), z)
        along = np.sin(down) * radial + np.array([0.0, 0.0, np.cos(down)])
        local = np.column_stack([along, np.cos(down) * radial - np.array([0.0, 0.0, np.sin(down)]), around])
    return np.asarray(system.axes @ local)
