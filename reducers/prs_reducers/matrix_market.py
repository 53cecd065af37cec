"""Matrices as Matrix Market files with a table of what their rows are: the plain case, and a way out."""

from __future__ import annotations

import io
from pathlib import Path
from typing import ClassVar

import numpy as np
from scipy.sparse import csr_array

from prs_model.arrays import FloatArray
from prs_model.description.schema import Section
from prs_model.description.units import Units
from prs_model.errors import PartFileError
from prs_model.finite_elements import FiniteElementModel
from prs_model.part_files import MODE, LabelledMatrices, full_model, read_text, super_element
from prs_model.part_files.labelled import LENGTH, in_file_units
from prs_model.part_files.text import file_access
from prs_model.plugins import PartRequest, Reducer
from prs_model.reduction import SuperElement
from prs_model.reduction.storage import whole

from .tables.dof_table import DofTable, digest, read_dof_table, write_dof_table
from .tables.mtx import is_mtx, parse_mtx, write_mtx

SIGNATURE = "stiffness-sha256"  # a fact in every table that `write` makes


class MatrixMarketOptions(Section):
    """Files beside the stiffness, relative to its folder; default ``<stem>_mass.mtx`` and ``<stem>_dofs.txt``.

    reduced: the matrices come from a condensation though no modes are among their rows.
    """

    mass: str | None = None
    dofs: str | None = None
    reduced: bool = False


class MatrixMarketReducer(Reducer[MatrixMarketOptions]):
    """K, M and a table of their rows (see `dof_table`), which may say the units.

    Rows in another order than the table's show in the physics gate only, and of a part held to the ground nowhere:
    export it free and clamp it here.
    """

    description: ClassVar[str] = "stiffness and mass as Matrix Market files, with a table of their rows"
    Options: ClassVar[type[Section]] = MatrixMarketOptions
    gives = "either"
    units = "optional"
    writes = (".mtx",)

    def read(self, part: PartRequest[MatrixMarketOptions]) -> FiniteElementModel | SuperElement:
        """A super-element where the table has modes or says so, full matrices otherwise. Raises PartFileError."""
        stiffness, mass, dofs = self.files(part)
        text = _market(stiffness)
        table = read_dof_table(dofs)
        units = table.units(part.units) or part.file_units
        if table.places is None:
            raise PartFileError(dofs, "has no coordinates: write x, y, z after the component")
        matrices = LabelledMatrices(
            source=stiffness,
            stiffness=_matrix(text, stiffness, "stiffness", table),
            mass=_matrix(_market(mass), mass, "mass", table),
            nodes=table.nodes,
            components=table.components,
        )
        if table.is_reduced or part.options.reduced:
            return super_element(matrices, table.places, units, modes=table.modes, node_sets=table.node_sets)
        sets = {name: table.places.places(np.array(nodes), dofs) for name, nodes in table.node_sets.items()}
        return full_model(matrices, table.places, units, node_sets=sets)

    def files(self, part: PartRequest[MatrixMarketOptions]) -> tuple[Path, ...]:
        """Stiffness, mass, table."""
        mass, dofs = companions(part.path)
        given = part.options
        return (
            part.path,
            part.path.parent / given.mass if given.mass else mass,
            part.path.parent / given.dofs if given.dofs else dofs,
        )

    def write(self, element: SuperElement, path: Path, units: Units) -> None:
        """Write ``part.mtx``, ``part_mass.mtx`` and ``part_dofs.txt``; each appears whole or not at all.

        Numbers have 17 digits, so in SI they come back as they were. The outer surface is left out. Raises
        PartFileError for an element whose coordinates are not the motions of nodes along the body's axes and modes.
        """
        _check_replaceable(path)
        nodes, components = coordinates_of(element, path)
        stiffness, mass = in_file_units(element.stiffness, element.mass, np.array(components), units)
        system = f"{units.length}-{units.force}-{units.mass}-s"
        texts = {
            "stiffness": _mtx_text(stiffness, f"stiffness of {element.name}, {system}"),
            "mass": _mtx_text(mass, f"mass of {element.name}, {system}"),
        }
        facts = {"reduced": "true", **{f"{name}-sha256": digest(text) for name, text in texts.items()}}
        if element.provenance.get("modes") == "fixed-interface":
            facts["modes"] = "fixed-interface"
        table = DofTable(path, np.array(nodes), np.array(components), None, facts, element.node_sets)
        positions = dict(zip(element.nodes, element.positions / LENGTH.factor(units), strict=True))
        held = ("held to the ground: say 'grounded: true'",) if element.grounded else ()
        rows = write_dof_table(table, system, positions, (f"rows of {element.name}", *held))
        beside = companions(path)
        for file, text in zip((*beside, path), (texts["mass"], rows, texts["stiffness"]), strict=True):
            with file_access(file, "written"), whole(file) as opened:
                opened.write(text.encode())


def companions(path: Path) -> tuple[Path, Path]:
    """Default names of the mass and of the table beside a stiffness."""
    stem = Path(path.name.removesuffix(".gz")).stem
    return path.with_name(f"{stem}_mass.mtx"), path.with_name(f"{stem}_dofs.txt")


def _check_replaceable(path: Path) -> None:
    """Raises PartFileError where files of these names are there that this program has not written."""
    mass, dofs = companions(path)
    there = [file for file in (path, mass, dofs) if file.exists()]
    if there and not (dofs.exists() and SIGNATURE in read_text(dofs)):
        raise PartFileError(there[0], "is there already, and was not written by this program: choose another name")


def coordinates_of(element: SuperElement, path: Path) -> tuple[list[str], list[int]]:
    """Node and component of each coordinate, of a mode its number and MODE. Raises PartFileError when it has none."""
    first_mode = element.size - element.n_modes
    nodes, components = [], []
    for column in range(element.size):
        moved = np.argwhere(element.motions[:, :, column])
        if column >= first_mode and len(moved) == 0:
            nodes.append(str(column - first_mode + 1))
            components.append(MODE)
        elif column < first_mode and len(moved) == 1 and element.motions[*moved[0], column] == 1.0:
            nodes.append(element.nodes[moved[0, 0]])
            components.append(int(moved[0, 1]))
        else:
            raise PartFileError(
                path,
                f"cannot hold {element.name}: coordinate '{element.labels[column]}' is not the motion of one node "
                "along one axis of the body; store it as .npz",
            )
    lost = [node for node in element.nodes if node not in nodes]
    if lost:
        raise PartFileError(path, f"cannot hold {element.name}: node '{lost[0]}' has no coordinate; store it as .npz")
    return nodes, components


def _market(path: Path) -> str:
    text = read_text(path)
    if not is_mtx(text):
        what = "is no Matrix Market file (%%MatrixMarket ..); a .mtx of Abaqus is read by the reducer 'abaqus'"
        raise PartFileError(path, what)
    return text


def _matrix(text: str, path: Path, name: str, table: DofTable) -> csr_array:
    matrix = parse_mtx(text, path, len(table.nodes))
    table.check_digest(name, text, path)
    return matrix


def _mtx_text(matrix: FloatArray, comment: str) -> str:
    file = io.StringIO()
    write_mtx(file, matrix, " ".join(comment.split()))
    return file.getvalue()
