"""Meshes of gmsh with the tags of their nodes."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from prs_model.arrays import IntArray
from prs_model.errors import PartFileError
from prs_model.part_files import NodeTable

from .gmsh_labels import node_labels
from .labelled_mesh import LabelledMesh
from .mesh_file import named_groups, node_groups, read_cells
from .solid_faces import CORNERS

SOLIDS = ("tetra", "tetra10", "wedge", "wedge15", "hexahedron", "hexahedron20")


def read_gmsh_mesh(path: Path) -> LabelledMesh:
    """Nodes with their tags, cells and physical groups of a .msh file. Raises PartFileError."""
    mesh = read_cells(path)
    labels = node_labels(path, mesh.points)
    if labels is None:
        raise PartFileError(path, "its node tags cannot be read; write it with gmsh as .msh, version 4.1 or 2.2, ASCII")
    solids: dict[int, list[IntArray]] = {}
    for block in mesh.cells:
        if block.type in SOLIDS:
            solids.setdefault(block.data.shape[1], []).append(np.asarray(block.data, dtype=np.int64))
    groups = node_groups(mesh, named_groups(mesh), np.arange(len(mesh.points)), frozenset())
    return LabelledMesh(
        table=NodeTable(path, labels, np.asarray(mesh.points, dtype=float)),
        solids={count: np.concatenate(blocks) for count, blocks in solids.items() if count in CORNERS},
        others=np.zeros(0, dtype=np.int64),
        node_sets={name: np.unique(nodes) for name, nodes in groups.items()},
    )
