"""Meshes beside matrices, whatever their format, as long as their nodes have labels."""

from __future__ import annotations

from pathlib import Path

from prs_model.errors import PartFileError

from .deck_mesh import read_deck_mesh
from .gmsh_mesh import read_gmsh_mesh
from .keyword_deck import deck_files
from .labelled_mesh import LabelledMesh

GMSH = ".msh"
LABELLESS = (".vtk", ".vtu", ".stl", ".ply", ".off", ".obj", ".xdmf", ".med", ".bdf", ".nas", ".unv", ".mesh")


def read_part_mesh(path: Path) -> LabelledMesh:
    """The mesh of a keyword deck, or of gmsh (.msh). Raises PartFileError."""
    if path.suffix.lower() in LABELLESS:
        raise PartFileError(path, "its node labels are not read; name a keyword deck (.inp) or a gmsh mesh (.msh)")
    return read_gmsh_mesh(path) if path.suffix.lower() == GMSH else read_deck_mesh(path)


def mesh_files(path: Path) -> tuple[Path, ...]:
    """Every file of a mesh: a deck with what it includes."""
    return (path,) if path.suffix.lower() == GMSH else deck_files(path)
