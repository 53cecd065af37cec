"""What the rows of exported ANSYS matrices are: a vector of node numbers, or the mapping file of HBMAT."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from prs_model.arrays import IntArray
from prs_model.errors import PartFileError, short
from prs_model.part_files import read_text

from ..tables.mtx import check_end, is_mtx

DOFS = {"UX": 0, "UY": 1, "UZ": 2, "ROTX": 3, "ROTY": 4, "ROTZ": 5}


def read_row_map(path: Path, rows: int) -> tuple[IntArray, IntArray]:
    """Node number and component (0..5) of each of so many rows. Raises PartFileError."""
    text = read_text(path)
    check_end(text, path)
    return _nodal_vector(text, path, rows) if is_mtx(text) else _mapping(text, path, rows)


def _nodal_vector(text: str, path: Path, rows: int) -> tuple[IntArray, IntArray]:
    """``*VEC,NodeMap,I,IMPORT,FULL,file.full,BACK`` exported as MMF: the node of each group of 3 (or 6) rows."""
    lines = [line.split() for line in text.splitlines() if line.strip() and not line.startswith("%")]
    numbers = [word for words in lines for word in words]
    if "array" not in text.splitlines()[0].lower() or not all(word.isascii() and word.isdigit() for word in numbers):
        raise PartFileError(path, "expected a dense vector of node numbers (*VEC,..,BACK exported as MMF)")
    head, nodes = [int(word) for word in lines[0]], [int(word) for words in lines[1:] for word in words]
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
        if len(words) != 3 or not words[0].isdigit() or not words[1].isdigit() or words[2].upper() not in DOFS:
            known = ", ".join(DOFS)
            what = f"line {count}, '{short(line.strip())}': expected equation, node and one of {known}"
            raise PartFileError(path, what)
        if int(words[0]) in found:
            raise PartFileError(path, f"line {count}: equation {words[0]} stands there twice")
        found[int(words[0])] = int(words[1]), DOFS[words[2].upper()]
    if set(found) != set(range(1, rows + 1)):
        raise PartFileError(
            path, f"maps {len(found)} equations, expected 1 to {rows}, one for each row of the matrices"
        )
    nodes, components = np.array([found[row] for row in range(1, rows + 1)]).T
    return nodes, components
