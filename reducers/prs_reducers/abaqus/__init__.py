"""Matrices that Abaqus writes as text (.mtx): of a whole model, or of a substructure."""

from __future__ import annotations

import re
from pathlib import Path
from typing import ClassVar

from prs_model.description.schema import Section
from prs_model.errors import PartFileError
from prs_model.finite_elements import FiniteElementModel
from prs_model.part_files import read_text
from prs_model.plugins import PartRequest, Reducer
from prs_model.reduction import SuperElement

from ..meshes.meshed_part import meshed_model
from ..meshes.part_mesh import mesh_files, read_part_mesh, wrong_source
from ..tables.user_element import is_user_element
from .matrix_output import read_matrices
from .substructure import read_substructure

NAMED = re.compile(r"(?P<job>.*?)(?P<what>[_-]?(STIF|MASS))(?P<step>\d+)(?P<suffix>(\.\w+)?(\.gz)?)", re.IGNORECASE)
OTHER_FILES = (".inp", ".odb", ".sim", ".fil", ".msh")
OTHER = {"stif": "mass", "mass": "stif", "STIF": "MASS", "MASS": "STIF"}


class AbaqusOptions(Section):
    """mass: the mass matrix beside the source; by default ``<job>_MASS1.mtx`` beside ``<job>_STIF1.mtx``.

    mesh: the deck (.inp) or gmsh mesh (.msh) beside the source; by default ``<job>.inp``.
    """

    mass: str | None = None
    mesh: str | None = None


class AbaqusReducer(Reducer[AbaqusOptions]):
    description: ClassVar[str] = (
        "Abaqus matrices (.mtx of *MATRIX OUTPUT or *SUBSTRUCTURE MATRIX OUTPUT) with their .inp"
    )
    Options: ClassVar[type[Section]] = AbaqusOptions
    gives = "either"
    units = "asked"

    def read(self, part: PartRequest[AbaqusOptions]) -> FiniteElementModel | SuperElement:
        """Read full matrices with their deck, or those of a substructure.

        FORMAT=COORDINATE does not label its rows: they are taken to be those of the nodes in the deck's order, with
        three or six motions each, which physics then confirms, except for shells and beams that are held. Motions held
        by 1e36 must be those that the deck holds. Raises PartFileError.
        """
        stiffness, mass, mesh = _paths(part)
        text = read_text(stiffness)
        if is_user_element(text):
            return read_substructure(text, stiffness, lambda: read_part_mesh(mesh), part.file_units)
        labelled = read_part_mesh(mesh)
        matrices = read_matrices(text, stiffness, _mass(part, mass), labelled)
        return meshed_model(matrices, labelled, part.file_units, {"mesh": mesh.name})

    def files(self, part: PartRequest[AbaqusOptions]) -> tuple[Path, ...]:
        stiffness, mass, mesh = _paths(part)
        return tuple(path for path in (stiffness, mass, *mesh_files(mesh)) if path is not None)


def _paths(part: PartRequest[AbaqusOptions]) -> tuple[Path, Path | None, Path]:
    """Stiffness, mass (None where no name leads to it) and mesh."""
    folder, options = part.path.parent, part.options
    if part.path.suffix.lower() in OTHER_FILES:
        what = "the stiffness (.mtx) that *MATRIX OUTPUT or *SUBSTRUCTURE MATRIX OUTPUT writes"
        raise wrong_source(part.path, f"{part.path.suffix} is not read", what, ("*.mtx", "*.mtx.gz"))
    found = NAMED.fullmatch(part.path.name)
    job = found["job"] if found else Path(part.path.name.removesuffix(".gz")).stem
    mesh = folder / (options.mesh or f"{job}.inp")
    if options.mass is not None or found is None:
        return part.path, (folder / options.mass if options.mass else None), mesh
    what = found["what"]
    other = what[:-4] + OTHER.get(what[-4:], "MASS")
    companion = folder / f"{job}{other}{found['step']}{found['suffix']}"
    return (part.path, companion, mesh) if what[-4:].upper() == "STIF" else (companion, part.path, mesh)


def _mass(part: PartRequest[AbaqusOptions], mass: Path | None) -> Path:
    if mass is None:
        raise PartFileError(part.path, "its name has no STIF1 to find a mass matrix by: say 'options: {mass: <file>}'")
    return mass
