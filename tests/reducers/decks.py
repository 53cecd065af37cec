"""Keyword decks and Abaqus' matrix files, written by test code as the solvers lay them down."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from prs_model.arrays import FloatArray, IntArray
from prs_model.finite_elements import FiniteElementModel
from prs_reducers.meshes.mesh_file import TetrahedralMesh


def write_deck(path: Path, mesh: TetrahedralMesh, labels: IntArray, *, scale: float = 1.0, more: str = "") -> Path:
    """Nodes and elements of a box (in m, written times `scale`), its sides as node sets; `more` follows them."""
    lines = ["** written by a test", "*NODE, NSET=NALL"]
    lines += [
        f"{label}, " + ", ".join(f"{x:.16g}" for x in p) for label, p in zip(labels, mesh.points * scale, strict=True)
    ]
    lines += ["*ELEMENT, TYPE=C3D10, ELSET=EALL"]
    lines += [f"{i}, " + ", ".join(map(str, labels[nodes])) for i, nodes in enumerate(mesh.elements, start=1)]
    for name in sorted(mesh.surfaces):
        lines += [f"*NSET, NSET=N{name}", *(f"{label}," for label in labels[np.unique(mesh.groups[name])])]
    path.write_text("\n".join(lines) + "\n" + more)
    return path


def write_labelled(path: Path, matrix: FloatArray, model: FiniteElementModel, labels: IntArray) -> Path:
    """FORMAT=MATRIX INPUT: node, dof, node, dof, value of one triangle."""
    rows, columns = np.nonzero(np.tril(matrix))
    name = [f"{labels[node]},{component + 1}" for node, component in model.dofs]
    path.write_text("".join(f"{name[i]}, {name[j]}, {matrix[i, j]:.15e}\n" for i, j in zip(rows, columns, strict=True)))
    return path


def write_user_element(path: Path, stiffness: FloatArray, mass: FloatArray | None, nodes: list[int]) -> Path:
    """*SUBSTRUCTURE MATRIX OUTPUT of nodes with three motions each: upper triangles by columns, four to a line."""
    lines = ["**", "** SUBSTRUCTURE", f"*USER ELEMENT,NODES= {len(nodes)},LINEAR", "** ELEMENT NODES"]
    lines += ["** " + ", ".join(map(str, nodes[i : i + 8])) for i in range(0, len(nodes), 8)]
    lines += ["1, 2, 3"]
    for kind, matrix in (("STIFFNESS", stiffness), ("MASS", mass)):
        if matrix is not None:
            lines.append(f"*MATRIX,TYPE={kind}")
            for column in range(len(matrix)):
                entries = [f"{value:.15E}" for value in matrix[: column + 1, column]]
                lines += [",".join(entries[i : i + 4]) for i in range(0, len(entries), 4)]
    path.write_text("\n".join(lines) + "\n")
    return path
