"""What the rows of exported ANSYS matrices are: the mapping file of HBMAT, or a vector of node numbers."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from prs_model.arrays import IntArray
from prs_model.errors import PartFileError, short
from prs_model.part_files import read_text
from prs_model.part_files.text import whole_number

from ..tables.mtx import check_end, is_mtx

DOFS = {"UX": 0, "UY": 1, "UZ": 2, "ROTX": 3, "ROTY": 4, "ROTZ": 5}


def read_row_map(path: Path, rows: int) -> tuple[IntArray, IntArray]:
    """Node number and component (0..5) of each of so many rows. Raises PartFileError."""
    text = read_text(path)
    check_end(text, path)
    return _nodal_vector(text, path, rows) if is_mtx(text) else _mapping(text, path, rows)


def _nodal_vector(text: str, path: Path, rows: int) -> tuple[IntArray, IntArray]:
    """``*VEC,MAP,I,IMPORT,FULL,part.full,BACK`` exported as MMF: the node of each group of 3 (or 6) rows.

    BACK speaks of the program's internal order, the matrices are in the solver's, which leaves DOFs out that are
    constrained or eliminated by equations. Without any of these the two are taken to be the same; the physics gate sees
    when they are not. (NOD2SOLV, which turns the one into the other, cannot be exported.)
    """
    lines = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("%")]
    try:
        numbers = [[whole_number(word) for word in words] for words in lines]
    except ValueError as error:
        raise PartFileError(path, f"{error}: expected the vector of node numbers (*VEC,..,BACK as MMF)") from error
    if "array" not in text.splitlines()[0].lower() or not numbers:
        raise PartFileError(path, "expected a dense vector of node numbers (*VEC,..,BACK exported as MMF)")
    head, nodes = numbers[0], [number for line in numbers[1:] for number in line]
    if len(head) != 2 or head[1] != 1 or head[0] != len(nodes) or not nodes:
        raise PartFileError(path, f"holds {len(nodes)} numbers, its size line says {head}: cut off or no vector")
    if 0 in nodes:
        raise PartFileError(path, "holds zeros: it is the FORWARD vector; export BACK, the node of each place")
    if len(set(nodes)) != len(nodes):
        raise PartFileError(path, "names a node twice: damaged, or not the BACK vector")
    each, rest = divmod(rows, len(nodes))
    if rest or each not in (3, 6):
        raise PartFileError(
            path,
            f"names {len(nodes)} nodes for {rows} rows, expected 3 or 6 rows a node; where DOFs are constrained, use "
            "the .mapping file of HBMAT, or the .full file itself",
        )
    return np.repeat(np.array(nodes, dtype=np.int64), each), np.tile(np.arange(each), len(nodes))


def _mapping(text: str, path: Path, rows: int) -> tuple[IntArray, IntArray]:
    """HBMAT's .mapping: a heading, then equation, node and DOF name in each line."""
    found: dict[int, tuple[int, int]] = {}
    for count, line in enumerate(text.splitlines(), start=1):
        words = line.split()
        if not words or (not found and not words[0].isdigit()):
            continue
        try:
            equation, node, component = _mapped(words)
        except ValueError as error:
            raise PartFileError(path, f"line {count}, '{short(line.strip())}': {error}") from error
        if equation in found:
            raise PartFileError(path, f"line {count}: equation {equation} stands there twice")
        found[equation] = node, component
    if set(found) != set(range(1, rows + 1)):
        raise PartFileError(
            path, f"maps {len(found)} equations, expected 1 to {rows}, one for each row of the matrices"
        )
    nodes, components = np.array([found[row] for row in range(1, rows + 1)]).T
    return nodes, components


def _mapped(words: list[str]) -> tuple[int, int, int]:
    if len(words) != 3 or words[2].upper() not in DOFS:
        raise ValueError(f"expected equation, node and one of {', '.join(DOFS)}")
    return whole_number(words[0]), whole_number(words[1]), DOFS[words[2].upper()]
