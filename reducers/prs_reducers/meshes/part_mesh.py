"""Meshes beside matrices, whatever their format, as long as their nodes have labels."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from prs_model.description.problems import listed
from prs_model.errors import PartFileError

from .deck_mesh import read_deck_mesh
from .gmsh_mesh import read_gmsh_mesh
from .keyword_deck import deck_files
from .labelled_mesh import LabelledMesh

GMSH = ".msh"
LABELLESS = (".vtk", ".vtu", ".stl", ".ply", ".off", ".obj", ".xdmf", ".med", ".bdf", ".nas", ".unv", ".mesh")


def read_part_mesh(path: Path) -> LabelledMesh:
    """The mesh of a keyword deck, or of gmsh (.msh). Raises PartFileError."""
    if not path.exists():
        raise PartFileError(
            path, "there is no such file: 'mesh' is looked for beside the source, a deck (.inp) or gmsh mesh (.msh)"
        )
    if path.suffix.lower() in LABELLESS:
        raise PartFileError(path, "its node labels are not read; name a keyword deck (.inp) or a gmsh mesh (.msh)")
    return read_gmsh_mesh(path) if path.suffix.lower() == GMSH else read_deck_mesh(path)


def mesh_files(path: Path) -> tuple[Path, ...]:
    """Every file of a mesh: a deck with what it includes."""
    return (path,) if path.suffix.lower() == GMSH else deck_files(path)


def wrong_source(path: Path, found: str, expected: str, patterns: Iterable[str]) -> PartFileError:
    """The error for a source of another kind, such as the mesh itself, naming files of the right kind beside it."""
    beside = sorted(each.name for pattern in patterns for each in path.parent.glob(pattern))
    near = f"; beside it {'is' if len(beside) == 1 else 'are'} {listed(beside, 4)}" if beside else ""
    return PartFileError(path, f"{found}, expected {expected}{near}")
