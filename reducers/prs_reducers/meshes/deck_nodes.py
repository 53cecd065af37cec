"""Nodes of a keyword deck: where they are, also in a moved instance, and the local axes of their motions."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.spatial.transform import Rotation

from prs_model.arrays import FloatArray

from .deck_sets import Sets, members_of
from .keyword_deck import Card, Fields

ONE_PART = (
    "a deck with several parts or instances numbers their nodes anew: merge them into one part, or write it without "
    "parts and assemblies"
)
GENERATORS = ("SYSTEM", "NGEN", "NCOPY", "NFILL", "NMAP", "ELGEN", "ELCOPY")
"""Keywords that make nodes and elements, or move the nodes that follow."""


def check_plain(cards: list[Card]) -> None:
    """Raises PartFileError when nodes or elements are not all written out in rectangular coordinates of one system."""
    for card in cards:
        mesh = card.keyword in ("NODE", "ELEMENT")
        if card.keyword in GENERATORS:
            raise card.error(card.line, f"*{card.keyword} is not read: write all nodes and elements out as they are")
        if mesh and card.options.get("INPUT"):
            raise card.error(card.line, f"*{card.keyword}, INPUT= is not read: use *INCLUDE, INPUT=")
        if mesh and card.options.get("SYSTEM", "R").upper() != "R":
            raise card.error(card.line, "*NODE, SYSTEM=C or S is not read: write rectangular coordinates")


def coordinates_of(cards: list[Card]) -> tuple[list[int], FloatArray]:
    """Labels and coordinates (k, 3) of all nodes, in the assembly's axes. Raises PartFileError."""
    check_plain(cards)
    instances = [card for card in cards if card.keyword == "INSTANCE"]
    if len(instances) > 1:
        raise instances[1].error(instances[1].line, f"a second *INSTANCE; {ONE_PART}")
    places: dict[int, list[float]] = {}
    inside: list[bool] = []
    for card in cards:
        if card.keyword != "NODE":
            continue
        for line, fields in card.data:
            label = card.whole(line, fields[0])
            if label in places:
                raise card.error(line, f"node {label} is defined twice; {ONE_PART}")
            places[label] = card.floats(line, fields[1:], 3)
            inside.append(bool(card.scope))
    points = np.array(list(places.values()), dtype=float).reshape(-1, 3)
    if instances:
        points[inside] = _moved(points[inside], instances[0])
    return list(places), points


def _moved(points: FloatArray, instance: Card) -> FloatArray:
    """Data lines of *INSTANCE: a translation, then two points of an axis and the angle about it [degrees]."""
    lines = list(instance.data)
    if lines:
        points = points + np.array(instance.floats(*lines[0], 3))
    if len(lines) > 1:
        *ends, angle = instance.floats(*lines[1], 7)
        start, axis = np.array(ends[:3]), np.array(ends[3:]) - np.array(ends[:3])
        if not np.any(axis):
            raise instance.error(lines[1][0], "*INSTANCE: the two points of the axis of rotation are one")
        turn = Rotation.from_rotvec(np.radians(angle) * axis / np.linalg.norm(axis)).as_matrix()
        points = (points - start) @ turn.T + start
    return points


def local_frames(cards: list[Card], points: FloatArray, places: dict[int, int], sets: Sets) -> FloatArray | None:
    """(k, 3, 3) axes of each node's motions as *TRANSFORM turns them, in columns; None where it turns none."""
    transforms = [card for card in cards if card.keyword == "TRANSFORM"]
    if not transforms:
        return None
    turned = next((card for card in cards if card.keyword == "INSTANCE" and len(card.data) > 1), None)
    if turned is not None:
        raise turned.error(turned.line, "*TRANSFORM in a turned instance is not read: write the part in its place")
    frames = np.tile(np.eye(3), (len(points), 1, 1))
    for card in transforms:
        name = card.option("NSET")
        one = replace(card, options={}, data=((card.line, (name,)),))
        nodes = members_of(one, sets, places, "node")
        line, fields = card.data[0] if card.data else (card.line, Fields())
        first, second = np.reshape(card.floats(line, fields, 6), (2, 3))
        kind = card.options.get("TYPE", "R").upper()
        if kind not in ("R", "C"):
            raise card.error(card.line, f"*TRANSFORM, TYPE={kind} is not read, expected R or C")
        for node in nodes:
            frames[node] = _rectangular(first, second) if kind == "R" else _cylindrical(first, second, points[node])
        if not np.all(np.isfinite(frames)):
            raise card.error(line, "*TRANSFORM: its two points give no axes there")
    return frames


def _rectangular(first: FloatArray, second: FloatArray) -> FloatArray:
    """x' towards the first point, y' in the plane of both."""
    x, normal = first, np.cross(first, second)
    return _columns(x, np.cross(normal, x), normal)


def _cylindrical(first: FloatArray, second: FloatArray, point: FloatArray) -> FloatArray:
    """Radial, tangential and along the axis through both points."""
    axis = second - first
    radial = (point - first) - axis * ((point - first) @ axis) / ((axis @ axis) or np.nan)
    return _columns(radial, np.cross(axis, radial), axis)


def _columns(*axes: FloatArray) -> FloatArray:
    return np.column_stack([axis / (np.linalg.norm(axis) or np.nan) for axis in axes])
