"""Keyword decks and Abaqus' matrix files, written by test code as the solvers lay them down."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np

import prs_model as prs
from prs_model.arrays import FloatArray, IntArray
from prs_model.finite_elements import FiniteElementModel
from prs_reducers.meshes.mesh_file import TetrahedralMesh
from tests.meshes import STEEL

BAR = (0.6, 0.02, 0.03)  # m
BAR_MASS = STEEL["density"] * BAR[0] * BAR[1] * BAR[2]


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


def write_bar(folder: Path) -> Path:
    """A steel bar of six beams along x, six motions a node, in m: job.inp and both matrices, the stiffness' path."""
    options = {
        "nodes": {"root": (0.0, 0.0, 0.0), "tip": (BAR[0], 0.0, 0.0)},
        "sections": {"bar": {"kind": "rectangle", "y": BAR[1], "z": BAR[2], "material": STEEL}},
        "members": ({"between": ("root", "tip"), "section": "bar", "elements": 6},),
    }
    model = prs.read_part("beam", options=options)
    assert isinstance(model, FiniteElementModel)
    labels = np.arange(1, len(model.coordinates) + 1)
    lines = ["*NODE", *(f"{label}, {x:.9g}, {y:.9g}, {z:.9g}" for label, (x, y, z) in enumerate(model.coordinates, 1))]
    along = [1, *labels[2:].tolist(), 2]  # both ends come first in the model
    lines += ["*ELEMENT, TYPE=B31", *(f"{label}, {a}, {b}" for label, (a, b) in enumerate(pairwise(along), 1))]
    lines += ["*NSET, NSET=x0", "1", "*NSET, NSET=x1", "2"]
    (folder / "job.inp").write_text("\n".join(lines) + "\n")
    write_labelled(folder / "job_MASS1.mtx", model.mass.toarray(), model, labels)
    return write_labelled(folder / "job_STIF1.mtx", model.stiffness.toarray(), model, labels)


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


def changed(path: Path, old: str, new: str) -> None:
    """Put `new` where `old` stands first in a file."""
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new, 1))
