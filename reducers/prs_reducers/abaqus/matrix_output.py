"""``*MATRIX OUTPUT``: sparse matrices as row, column, value, or as node, dof, node, dof, value."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.sparse import coo_array, csr_array

from prs_model.arrays import BoolArray, FloatArray, IntArray
from prs_model.errors import PartFileError, short
from prs_model.part_files import LabelledMatrices, read_text

from ..meshes.labelled_mesh import LabelledMesh
from ..meshes.mesh_agreement import sentence_of
from ..tables.number_table import read_table, whole_numbers

HELD = 1e36
"""What Abaqus writes on the diagonal of the stiffness of a motion that is held."""
LARGEST = 1e30
"""No stiffness of a part is as large, in any units."""
INTERNAL = (
    "nodes that Abaqus makes inside (negative labels; of hybrid beams, couplings and contact): "
    "use plain solid, shell or B31 and B32 elements, and leave couplings to the interfaces"
)


@dataclass(frozen=True, eq=False)
class Entries:
    """Entries of one matrix: rows and columns (m, 1) as numbers, or (m, 2) as node and dof; values (m,)."""

    path: Path
    rows: IntArray
    columns: IntArray
    values: FloatArray


def read_matrices(text: str, stiffness: Path, mass: Path, mesh: LabelledMesh) -> LabelledMatrices:
    """Stiffness (whose content is `text`) and mass with their labels, without motions that are held.

    Raises PartFileError.
    """
    of_k, of_m = _entries(text, stiffness), _entries(read_text(mass), mass)
    if of_k.rows.shape[1] != of_m.rows.shape[1]:
        raise PartFileError(mass, f"is written in another FORMAT than {stiffness.name}: write both in one step")
    if of_k.rows.shape[1] == 1:
        labels = _in_order_of_nodes(int(max(of_k.rows.max(), of_k.columns.max())), stiffness, mesh)
        k, m = (_matrix(each, each.rows[:, 0] - 1, each.columns[:, 0] - 1, len(labels)) for each in (of_k, of_m))
    else:
        labels, numbers = np.unique(np.concatenate([of_k.rows, of_k.columns]), axis=0, return_inverse=True)
        at = numbers.reshape(2, -1)
        k = _matrix(of_k, at[0], at[1], len(labels))
        m = _matrix(of_m, _found(of_m, of_m.rows, labels), _found(of_m, of_m.columns, labels), len(labels))
    free = _free(k, labels, stiffness, mesh)
    labels = labels[free]
    return LabelledMatrices(
        stiffness, csr_array(k[free][:, free]), csr_array(m[free][:, free]), labels[:, 0], labels[:, 1] - 1
    )


def _free(stiffness: csr_array, labels: IntArray, path: Path, mesh: LabelledMesh) -> IntArray:
    """The rows that Abaqus does not hold. Raises PartFileError when the deck holds others.

    labels (n, 2): node and dof of each row.
    """
    diagonal = stiffness.diagonal()
    held = np.isclose(diagonal, HELD, rtol=1e-3, atol=0.0)
    if np.any(wrong := ~held & (np.abs(diagonal) > LARGEST)):
        row = int(np.argmax(wrong))
        node, dof = labels[row]
        raise PartFileError(
            path,
            f"found {diagonal[row]:.4g} on the diagonal for node {node}, dof {dof}; Abaqus writes {HELD:g} where it "
            "holds a motion, and less elsewhere: damaged",
        )
    if np.any(held) and mesh.held is not None and len(mesh.held):
        _check_held(np.column_stack([mesh.table.places(labels[:, 0], path), labels[:, 1] - 1]), held, path, mesh)
    return np.flatnonzero(~held)


def _check_held(rows: IntArray, held: BoolArray, path: Path, mesh: LabelledMesh) -> None:
    """rows (n, 2): place in the mesh and component 0..5; held (n,): in the file, along each node's own axes."""
    by_deck = set() if mesh.held is None else {tuple(pair) for pair in mesh.held.tolist()}
    unlike = np.array([(tuple(row) in by_deck) != here for row, here in zip(rows.tolist(), held, strict=True)])
    if np.any(unlike):
        raise PartFileError(
            path,
            f"{np.count_nonzero(unlike)} motions are held here or by *BOUNDARY of {mesh.table.source.name}, but not by "
            f"both: {sentence_of(rows[unlike], mesh)}; damaged, or of another step: name a deck that holds what this "
            "step does with the option 'mesh'",
        )


def _entries(text: str, path: Path) -> Entries:
    if "*" in text:
        text = "\n".join(_without_comment(line, path) for line in text.splitlines())
    plain = text.replace(",", " ")
    width = next((len(line.split()) for line in plain.splitlines() if line.strip()), 0)
    if width not in (3, 5):
        raise PartFileError(
            path,
            f"its lines hold {width} numbers, expected 3 (FORMAT=COORDINATE) or 5 (FORMAT=MATRIX INPUT) as *MATRIX "
            "OUTPUT of Abaqus writes them",
        )
    table = read_table(plain, path, width)
    numbers = whole_numbers(table[:, :-1], path, "row and column")
    half = numbers.shape[1] // 2
    if not np.all(np.isfinite(table[:, -1])):
        found = table[np.argmin(np.isfinite(table[:, -1]))]
        where = ", ".join(f"{each:g}" for each in found[:-1])
        raise PartFileError(path, f"found {found[-1]:g} in the entry {where}, expected a number: damaged")
    entries = Entries(path, numbers[:, :half], numbers[:, half:], table[:, -1])
    _check(entries)
    return entries


def _without_comment(line: str, path: Path) -> str:
    if line.lstrip().startswith("*") and not line.lstrip().startswith("**"):
        raise PartFileError(path, f"found '{short(line.strip(), 60)}', expected a stiffness or mass matrix only")
    return "" if line.lstrip().startswith("**") else line


def _check(entries: Entries) -> None:
    labels = np.concatenate([entries.rows, entries.columns])
    if np.any(labels[:, 0] < 1):
        raise PartFileError(entries.path, f"{np.count_nonzero(labels[:, 0] < 1)} entries belong to {INTERNAL}")
    if labels.shape[1] == 2 and np.any((labels[:, 1] < 1) | (labels[:, 1] > 6)):
        wrong = labels[(labels[:, 1] < 1) | (labels[:, 1] > 6)][0]
        raise PartFileError(
            entries.path, f"node {wrong[0]} has dof {wrong[1]}, expected displacements and rotations, 1..6"
        )


def _in_order_of_nodes(size: int, path: Path, mesh: LabelledMesh) -> IntArray:
    """(size, 2) node labels and dofs of unlabelled rows: nodes in the deck's order, three or six motions each."""
    everything = np.arange(len(mesh.table.labels))
    for nodes in (mesh.in_elements, everything):
        for motions in (3, 6):
            if motions * len(nodes) == size:
                labels = np.repeat(mesh.table.labels[nodes], motions)
                return np.column_stack([labels, np.tile(np.arange(1, motions + 1), len(nodes))])
    raise PartFileError(
        path,
        f"has {size} rows, but {mesh.table.source.name} has {len(everything)} nodes, {len(mesh.in_elements)} of them "
        "in elements, and rows are three or six to a node: truncated, or of another deck; where nodes differ in their "
        "motions write FORMAT=MATRIX INPUT, which labels its rows",
    )


def _found(entries: Entries, wanted: IntArray, labels: IntArray) -> IntArray:
    """Where (node, dof) pairs stand among the sorted `labels`."""
    keys, own = labels[:, 0] * 8 + labels[:, 1], wanted[:, 0] * 8 + wanted[:, 1]
    at = np.minimum(np.searchsorted(keys, own), len(keys) - 1)
    strangers = np.flatnonzero(keys[at] != own)
    if len(strangers):
        node, dof = wanted[strangers[0]]
        raise PartFileError(entries.path, f"has node {node}, dof {dof}, which the stiffness has not: of another part")
    return at


def _matrix(entries: Entries, rows: IntArray, columns: IntArray, size: int) -> csr_array:
    """Both triangles, whether the file has them or one, whose entries may lie on either side of the diagonal here."""
    if max(rows.max(), columns.max()) >= size:
        raise PartFileError(entries.path, f"has row {max(rows.max(), columns.max()) + 1}, the stiffness {size}")
    keys, inner = rows * size + columns, np.flatnonzero(rows != columns)
    if len(np.unique(keys)) < len(keys):
        raise PartFileError(entries.path, "has two values for one row and column: damaged, or two files in one")
    values = entries.values
    if not np.any(np.isin(columns[inner] * size + rows[inner], keys)):
        values = np.append(values, values[inner])
        rows, columns = np.append(rows, columns[inner]), np.append(columns, rows[inner])
    return csr_array(coo_array((values, (rows, columns)), shape=(size, size)))
