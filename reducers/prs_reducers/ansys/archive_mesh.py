"""The elements of an ANSYS archive (EBLOCK of a .cdb), to hold matrices against them."""

from __future__ import annotations

import re
from collections import defaultdict

import numpy as np

from prs_model.arrays import IntArray
from prs_model.errors import PartFileError
from prs_model.part_files import NodeTable

from ..meshes.labelled_mesh import LabelledMesh

SOLIDS = (45, 92, 95, 185, 186, 187)
"""Structural solids with three motions a node."""

_HEAD = re.compile(r"EBLOCK,\s*19\s*,\s*SOLID", re.IGNORECASE)
_FORMAT = re.compile(r"\(19i([1-9]\d?)", re.IGNORECASE)
_TYPE = re.compile(r"ET,\s*(\d{1,9})\s*,\s*(\d{1,9})", re.IGNORECASE)
_EQUATIONS = re.compile(r"(CE|CP)\s*,", re.IGNORECASE)


def mesh_of(lines: list[str], table: NodeTable) -> LabelledMesh | None:
    """The mesh of an archive's lines; None where it has no elements, or equations that eliminate motions.

    Raises PartFileError when the block of elements is damaged or names nodes that are not there.
    """
    starts = [at for at, line in enumerate(lines) if _HEAD.match(line.strip())]
    if len(starts) != 1 or any(_EQUATIONS.match(line.strip()) for line in lines):
        return None
    types = {int(found[1]): int(found[2]) for line in lines if (found := _TYPE.match(line.strip()))}
    solids: dict[int, list[IntArray]] = defaultdict(list)
    others: list[IntArray] = [np.zeros(0, dtype=np.int64)]
    for kind, nodes in _elements(lines, starts[0], table):
        if types.get(kind) in SOLIDS:
            solids[len(nodes)].append(nodes)
        else:
            others.append(nodes)
    by_count = {count: np.array(elements) for count, elements in solids.items()}
    return LabelledMesh(table, by_count, np.unique(np.concatenate(others)), node_sets={})


def _elements(lines: list[str], start: int, table: NodeTable) -> list[tuple[int, IntArray]]:
    """Type number and places of the nodes, each once, of all elements."""
    form = _FORMAT.search(lines[start + 1]) if start + 1 < len(lines) else None
    if form is None:
        raise PartFileError(table.source, f"line {start + 2}: expected the format of EBLOCK, such as (19i9)")
    place = {label: index for index, label in enumerate(table.labels.tolist())}
    elements: list[tuple[int, IntArray]] = []
    fields: list[int] = []
    for count, line in enumerate(lines[start + 2 :], start=start + 3):
        if not fields and line.strip() == "-1":
            return elements
        try:
            fields += _integers(line, int(form[1]))
            if len(fields) < 12 or len(fields) < 11 + fields[8]:
                continue
            if len(fields) != 11 + fields[8]:
                raise ValueError(f"found {len(fields) - 11} nodes, expected {fields[8]}")
            nodes = [place[node] for node in dict.fromkeys(fields[11:]) if node != 0]
        except (ValueError, KeyError) as error:
            what = f"node {error} is not there" if isinstance(error, KeyError) else error
            raise PartFileError(table.source, f"line {count}, EBLOCK: {what}: damaged") from error
        elements.append((fields[1], np.array(nodes, dtype=np.int64)))
        fields = []
    raise PartFileError(table.source, "EBLOCK has no end (-1): cut off")


def _integers(line: str, width: int) -> list[int]:
    text = line.rstrip()
    return [int(text[at : at + width]) for at in range(0, len(text), width)]
