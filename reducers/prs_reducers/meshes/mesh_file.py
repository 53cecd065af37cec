"""Meshes of tetrahedra and their named groups, whatever the file format calls them."""

from __future__ import annotations

import contextlib
import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from prs_model.arrays import FloatArray, IntArray
from prs_model.errors import PartFileError

from .deck_nodes import check_plain, coordinates_of
from .gmsh_labels import node_labels
from .gmsh_sections import check_sections
from .keyword_deck import read_cards

Named = Mapping[str, list[tuple[int, IntArray]]]
"""For each group of the file: the cell blocks it is made of, and which of their cells."""

TETRAHEDRA = ("tetra10", "tetra")
OTHER_SOLIDS = ("hexahedron", "wedge", "pyramid")
DIMENSIONS = {"vertex": 0, "line": 1, "triangle": 2, "quad": 2, "tetra": 3, "hexahedron": 3, "wedge": 3, "pyramid": 3}


@dataclass(frozen=True, eq=False)
class TetrahedralMesh:
    """points (n, 3) in the file's unit, all of them used. labels (n,): as gmsh's .msh and decks state them, else None.

    elements (e, 4 or 10) in VTK's order. groups: the nodes of each named group as an array of any shape, one row per
    face for those in `surfaces`; volumes: element indices of the groups made of elements.
    """

    source: Path
    points: FloatArray
    elements: IntArray
    groups: Mapping[str, IntArray]
    surfaces: frozenset[str]
    volumes: Mapping[str, IntArray]
    labels: IntArray | None = None


def read_mesh(path: Path) -> TetrahedralMesh:
    """Read a mesh file. Raises PartFileError when meshio cannot, or it is not one of tetrahedra."""
    mesh = read_cells(path)
    solid = _solid_blocks(mesh, path)
    used, compact = np.unique(np.concatenate([mesh.cells[block].data for block in solid]), return_inverse=True)
    place = np.full(len(mesh.points), -1)
    place[used] = np.arange(len(used))
    elements = compact.reshape(-1, mesh.cells[solid[0]].data.shape[1])
    named = named_groups(mesh)
    labels = _labels(path, np.asarray(mesh.points, dtype=float))
    surfaces = frozenset(name for name, parts in named.items() if _kinds(mesh, parts) in ({"triangle6"}, {"triangle"}))
    return TetrahedralMesh(
        source=path,
        points=np.asarray(mesh.points, dtype=float)[used],
        elements=elements,
        groups=node_groups(mesh, named, place, surfaces),
        surfaces=surfaces,
        volumes=_volumes(mesh, named, solid),
        labels=None if labels is None else labels[used],
    )


def read_cells(path: Path) -> Any:
    """The file as meshio has it, which prints and exits where we raise."""
    import meshio

    said = io.StringIO()
    try:
        with contextlib.redirect_stdout(said), contextlib.redirect_stderr(said):
            mesh = meshio.read(path)
    except (Exception, SystemExit) as error:
        reason = " ".join(said.getvalue().split()) or str(error) or type(error).__name__
        raise PartFileError(
            path, f"meshio cannot read it as a mesh ({reason}); write it again, for example as .msh"
        ) from error
    if np.ndim(mesh.points) != 2 or np.shape(mesh.points)[1] != 3 or not np.all(np.isfinite(mesh.points)):
        raise PartFileError(path, f"points have shape {np.shape(mesh.points)}, expected (n, 3) finite numbers")
    if path.suffix.lower() == ".msh":
        check_sections(path)
    return mesh


def _labels(path: Path, points: FloatArray) -> IntArray | None:
    """Labels of the points, where the file's own reader finds the same points in the same order. Raises PartFileError
    for a deck whose nodes are not all written out.
    """
    if path.suffix.lower() == ".msh":
        return node_labels(path, points)
    if path.suffix.lower() != ".inp":
        return None
    cards = read_cards(path)
    check_plain(cards)  # meshio takes no notice of what it cannot read
    try:
        labels, own = coordinates_of(cards)
    except PartFileError:  # such as a deck of several instances, whose labels are not unique
        return None
    return np.array(labels, dtype=np.int64) if np.array_equal(own, points) else None


def _solid_blocks(mesh: Any, path: Path) -> list[int]:
    found = sorted({block.type for block in mesh.cells})
    others = [kind for kind in found if kind.startswith(OTHER_SOLIDS)]
    kinds = [kind for kind in found if kind in TETRAHEDRA]
    if others or len(kinds) != 1:
        raise PartFileError(
            path, f"found cells {', '.join(found) or 'none'}, expected solid cells of one kind, tetra10 (or tetra)"
        )
    return [index for index, block in enumerate(mesh.cells) if block.type == kinds[0]]


def named_groups(mesh: Any) -> Named:
    """Groups of cells: meshio's cell sets, and gmsh's physical groups where the format has them as tags only."""
    named: dict[str, list[tuple[int, IntArray]]] = {}
    for name, by_block in (mesh.cell_sets or {}).items():
        if not name.startswith("gmsh:"):
            cells = [np.asarray([] if found is None else found, dtype=np.int64) for found in by_block]
            named[name] = [(block, found) for block, found in enumerate(cells) if len(found)]
    tags = mesh.cell_data.get("gmsh:physical", [])
    for name, (tag, dimension) in mesh.field_data.items():
        if not named.get(name):
            cells = [np.flatnonzero(np.asarray(of_block) == tag) for of_block in tags]
            named[name] = [
                (block, found)
                for block, found in enumerate(cells)
                if len(found) and _dimension(mesh.cells[block].type) == dimension
            ]
    return {name: parts for name, parts in named.items() if parts}


def _kinds(mesh: Any, parts: list[tuple[int, IntArray]]) -> set[str]:
    return {mesh.cells[block].type for block, _ in parts}


def _dimension(kind: str) -> int:
    return DIMENSIONS.get(kind.rstrip("0123456789"), -1)


def node_groups(mesh: Any, named: Named, place: IntArray, surfaces: frozenset[str]) -> dict[str, IntArray]:
    """Nodes of every group that belong to the solid; a face counts when all of its nodes do."""
    groups = {}
    for name, parts in named.items():
        cells = [place[mesh.cells[block].data[found]] for block, found in parts]
        if name in surfaces:
            faces = np.concatenate(cells)
            groups[name] = faces[np.all(faces >= 0, axis=1)]
        else:
            groups[name] = np.concatenate([each.ravel() for each in cells])
    for name, nodes in (mesh.point_sets or {}).items():
        groups.setdefault(name, place[np.asarray(nodes, dtype=np.int64)])
    return {name: nodes if name in surfaces else nodes[nodes >= 0] for name, nodes in groups.items()}


def _volumes(mesh: Any, named: Named, solid: list[int]) -> dict[str, IntArray]:
    lengths = [len(mesh.cells[block].data) for block in solid]
    starts = dict(zip(solid, np.cumsum([0, *lengths]), strict=False))
    return {
        name: np.concatenate([starts[block] + found for block, found in parts])
        for name, parts in named.items()
        if all(block in starts for block, _ in parts)
    }
