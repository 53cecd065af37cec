"""``*SUBSTRUCTURE MATRIX OUTPUT, OUTPUT FILE=USER DEFINED``: reduced matrices written as a linear user element."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import numpy as np

from prs_model.arrays import FloatArray, IntArray
from prs_model.description.units import Units
from prs_model.errors import PartFileError
from prs_model.part_files import LabelledMatrices, super_element
from prs_model.part_files.text import number
from prs_model.reduction import SuperElement

from ..meshes.labelled_mesh import LabelledMesh
from ..tables.user_element import HEAD, OF_CALCULIX

FREE = 1e-6
MATRIX = re.compile(r"^\*MATRIX\s*,\s*TYPE\s*=\s*(\w+)[^\n]*$", re.IGNORECASE | re.MULTILINE)


def read_substructure(text: str, path: Path, mesh: Callable[[], LabelledMesh], units: Units) -> SuperElement:
    """The super-element, its nodes placed by the deck. Raises PartFileError.

    The entries of each matrix are its upper triangle column by column. Retained eigenmodes are not read: Abaqus does
    not document how they stand in this file.
    """
    heads = list(HEAD.finditer(text))
    if len(heads) > 1:
        raise PartFileError(path, f"holds {len(heads)} elements, expected one substructure: *ELEMENT MATRIX OUTPUT")
    if "UNSYM" in heads[0][2].upper():
        raise PartFileError(path, "its matrices are unsymmetric, which those of an elastic part are not")
    parts = MATRIX.split(text[heads[0].end() :])
    nodes, components = _labels(parts[0], int(heads[0][1]), path)
    matrices = {
        kind.upper(): _upper(block, len(nodes), kind, path)
        for kind, block in zip(parts[1::2], parts[2::2], strict=True)
    }
    if "STIFFNESS" not in matrices:
        raise PartFileError(path, "has no *MATRIX, TYPE=STIFFNESS")
    _refuse_calculix(text, path, matrices["STIFFNESS"], components)
    if "MASS" not in matrices:
        raise PartFileError(path, "has no *MATRIX, TYPE=MASS: ask for MASS=YES in *SUBSTRUCTURE MATRIX OUTPUT")
    labelled = LabelledMatrices(path, matrices["STIFFNESS"], matrices["MASS"], nodes, components)
    placed = mesh()
    retained = set(nodes.tolist())
    sets = {
        name: tuple(str(label) for label in placed.table.labels[members].tolist() if label in retained)
        for name, members in placed.node_sets.items()
    }
    return super_element(
        labelled,
        placed.table,
        units,
        node_sets={name: members for name, members in sets.items() if members},
        provenance={"source": str(path), "mesh": placed.table.source.name},
    )


def _labels(head: str, count: int, path: Path) -> tuple[IntArray, IntArray]:
    """Node and component (0..5) of each row: node labels in comments, then dofs from each node's number on."""
    comments = [line[2:] for line in head.splitlines() if line.startswith("**")]
    nodes = [int(word) for word in re.findall(r"-?\d+", " ".join(comments))]
    lines = [line for line in head.splitlines() if line.strip() and not line.startswith("*")]
    if len(nodes) != count or not lines:
        raise PartFileError(
            path, f"names {len(nodes)} element nodes and {len(lines)} lists of dofs, expected {count} nodes"
        )
    if min(nodes) < 1:
        raise PartFileError(
            path,
            "has nodes that Abaqus makes inside, as for retained eigenmodes, whose layout is not documented: write the "
            "full matrices (*MATRIX OUTPUT), which are reduced here",
        )
    first, *changes = (_whole(line, path) for line in lines)
    of_node, starts = {1: first}, {change[0]: change[1:] for change in changes}
    for position in range(1, count + 1):
        of_node[position] = starts.get(position, of_node.get(position - 1, first))
    pairs = [(node, dof) for position, node in enumerate(nodes, 1) for dof in of_node[position]]
    if any(not 1 <= dof <= 6 for _, dof in pairs):
        raise PartFileError(path, "has dofs other than displacements and rotations, 1..6")
    labels, components = np.array(pairs, dtype=np.int64).T
    return labels, components - 1


def _whole(line: str, path: Path) -> list[int]:
    try:
        return [int(word) for word in line.replace(",", " ").split()]
    except ValueError as error:
        raise PartFileError(path, f"found '{line.strip()}', expected the dofs of element nodes") from error


def _upper(block: str, size: int, kind: str, path: Path) -> FloatArray:
    """The symmetric matrix of an upper triangle, column by column; text that follows it begins with a star."""
    words = block.partition("*")[0].replace(",", " ").split()
    expected = size * (size + 1) // 2
    if len(words) != expected:
        raise PartFileError(
            path, f"{kind}: found {len(words)} entries, expected {expected} for {size} motions: truncated"
        )
    try:
        values = np.array([number(word) for word in words])
    except ValueError as error:
        raise PartFileError(path, f"{kind}: {error}") from error
    matrix = np.zeros((size, size))
    matrix[np.tril_indices(size)] = values
    return np.asarray(matrix + np.tril(matrix, -1).T)


def _refuse_calculix(text: str, path: Path, stiffness: FloatArray, components: IntArray) -> None:
    """CalculiX names its file so; its stiffness lets no translation be free, as it is not condensed."""
    shifts = np.equal.outer(components, np.arange(3)).astype(float)
    force = np.linalg.norm(stiffness @ shifts) / (np.linalg.norm(stiffness) * np.linalg.norm(shifts) or 1.0)
    if "GENERATION OF SUBSTRUCTURE" in text[:1000] and force > FREE:
        raise PartFileError(path, f"is {OF_CALCULIX} (here |K t| / |K| |t| = {force:.2g} for translations t)")
