"""Full matrices of CalculiX, as ``*FREQUENCY, SOLVER=MATRIXSTORAGE`` writes them."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import ClassVar

import numpy as np
from scipy.sparse import csr_array

from prs_model.arrays import FloatArray, IntArray
from prs_model.description.schema import Section
from prs_model.errors import PartFileError
from prs_model.finite_elements import FiniteElementModel
from prs_model.part_files import LabelledMatrices, read_text
from prs_model.plugins import PartRequest, Reducer

from .meshes.labelled_mesh import LabelledMesh
from .meshes.mesh_agreement import missing_rows, sentence_of
from .meshes.meshed_part import meshed_model
from .meshes.part_mesh import mesh_files, read_part_mesh, wrong_source
from .tables.number_table import read_table, whole_numbers
from .tables.user_element import OF_CALCULIX, is_user_element

SUFFIXES = (".sti", ".mas", ".dof")


class CalculixOptions(Section):
    """mesh: the deck (.inp) or gmsh mesh (.msh) beside the source; by default ``<source>.inp``.

    A gmsh mesh does not say which motions are held: that only those have no rows is then not seen.
    """

    mesh: str | None = None


class CalculixReducer(Reducer[CalculixOptions]):
    description: ClassVar[str] = (
        "full matrices of CalculiX (.sti, .mas, .dof, also gzipped) with their mesh (.inp, .msh)"
    )
    Options: ClassVar[type[Section]] = CalculixOptions
    gives = "full"
    units = "asked"

    def read(self, part: PartRequest[CalculixOptions]) -> FiniteElementModel:
        """Read the matrices and their mesh, whose sets become node sets.

        Motions held by *BOUNDARY have no rows; such a part is grounded. Of a grounded part, a row in a wrong place is
        seen unless it stands beside a held node. Raises PartFileError.
        """
        stiffness, mass, dof, mesh = _paths(part)
        nodes, components = _labels(dof)
        rows, columns, of_k = _triangle(stiffness, dof, len(nodes))
        mass_rows, mass_columns, of_m = _triangle(mass, dof, len(nodes))
        if not (np.array_equal(rows, mass_rows) and np.array_equal(columns, mass_columns)):
            raise PartFileError(
                mass, f"its entries are not at the places of those in {stiffness.name}: of another job, or damaged"
            )
        k, m = (_mirrored(len(nodes), rows, columns, values) for values in (of_k, of_m))
        labelled = read_part_mesh(mesh)
        _check_nodes(nodes, components, dof, labelled)
        matrices = LabelledMatrices(stiffness, k, m, nodes, components)
        _check_held(matrices, labelled)
        table = replace(labelled.table, frames=None)  # the matrices are in global axes whatever *TRANSFORM says
        return meshed_model(matrices, replace(labelled, table=table), part.file_units, {"mesh": mesh.name})

    def files(self, part: PartRequest[CalculixOptions]) -> tuple[Path, ...]:
        stiffness, mass, dof, mesh = _paths(part)
        return stiffness, mass, dof, *mesh_files(mesh)


def _paths(part: PartRequest[CalculixOptions]) -> tuple[Path, Path, Path, Path]:
    """Stiffness, mass, rows and mesh: companions are gzipped or not, whatever the source is."""
    source = part.path
    stem = _stem(source)
    stiffness, mass, dof = (_companion(source, stem + suffix) for suffix in SUFFIXES)
    return stiffness, mass, dof, source.parent / (part.options.mesh or f"{stem}.inp")


def _stem(source: Path) -> str:
    """The name without suffixes of one of the three files, gzipped or not, or as it stands of all of them."""
    name = source.name.removesuffix(".gz")
    if name.endswith(SUFFIXES):
        return name[:-4]
    if not source.is_file() and _companion(source, f"{name}.sti").is_file():
        return name
    if source.suffix == ".mtx" and source.is_file() and is_user_element(read_text(source)):
        raise PartFileError(source, f"expected .sti or .sti.gz; this is {OF_CALCULIX}")
    found = f"{source.suffix} is not read" if source.suffix else "there is no such file"
    what = ".sti or .sti.gz, the stiffness that *FREQUENCY, SOLVER=MATRIXSTORAGE writes"
    raise wrong_source(source, found, what, ("*.sti", "*.sti.gz"))


def _companion(source: Path, name: str) -> Path:
    """The file of that name beside the source; the source itself, or packed as the source is, where there are two."""
    both = [source.with_name(name), source.with_name(f"{name}.gz")]
    if source.suffix == ".gz":
        both.reverse()
    return next((path for path in both if path.is_file()), both[0])


def _labels(path: Path) -> tuple[IntArray, IntArray]:
    """Node and component (0..2) of each row, from lines such as ``17.3``."""
    text = read_text(path)
    rows = whole_numbers(read_table(text, path, 2, separator="."), path, "node.component")
    nodes, components = rows.T
    wrong = np.flatnonzero((components < 1) | (components > 3) | (nodes < 1))
    if len(wrong):
        found = ".".join(map(str, rows[wrong[0]]))
        raise PartFileError(path, f"row {wrong[0] + 1} is '{found}', expected node.1 to node.3, a displacement")
    return nodes, components - 1


def _triangle(path: Path, dof: Path, size: int) -> tuple[IntArray, IntArray, FloatArray]:
    """Rows, columns and values of an upper triangle, which stands there column by column, each with its diagonal.

    size: the number of rows in `dof`.
    """
    text = read_text(path)
    if is_user_element(text):
        raise PartFileError(path, f"this is {OF_CALCULIX}")
    table = read_table(text, path, 3)
    rows, columns = whole_numbers(table[:, :2], path, "row and column").T
    last = (int(rows[-1]), int(columns[-1]))
    if last != (size, size):
        raise PartFileError(
            path,
            f"its last entry is {last[0]} {last[1]}, expected {size} {size}, as many as {dof.name} has rows: one of "
            "both is truncated, or of another job",
        )
    steps = np.diff(columns * (size + 1) + rows)
    ends = rows[np.append(np.diff(columns) > 0, True)]
    if np.any(steps <= 0) or np.any(rows < 1) or not np.array_equal(ends, np.arange(1, size + 1)):
        raise PartFileError(path, "not an upper triangle column by column, each down to its diagonal: damaged")
    return rows - 1, columns - 1, table[:, 2]


def _mirrored(size: int, rows: IntArray, columns: IntArray, values: FloatArray) -> csr_array:
    upper = csr_array((values, (rows, columns)), shape=(size, size))
    inner = rows != columns
    return csr_array(upper + csr_array((values[inner], (columns[inner], rows[inner])), shape=(size, size)))


def _check_nodes(nodes: IntArray, components: IntArray, path: Path, mesh: LabelledMesh) -> None:
    """Every row is of a node of the mesh, and no two are of one motion."""
    strangers, rows = np.setdiff1d(nodes, mesh.table.labels), np.unique(nodes * 3 + components)
    if len(strangers):
        what = f"{len(strangers)} of its nodes are not in {mesh.table.source.name} (the first is {strangers[0]})"
    elif len(rows) < len(nodes):
        what = f"{len(nodes) - len(rows)} motions have more than one row"
    else:
        return
    raise PartFileError(
        path,
        f"{what}: the mesh of another part, or one of shells, beams or C3D8I, whose nodes CalculiX makes itself: "
        "use C3D10, C3D20R, C3D15 or C3D8",
    )


def _check_held(matrices: LabelledMatrices, mesh: LabelledMesh) -> None:
    """Every motion without a row is one that the deck holds, in global axes."""
    missing = missing_rows(matrices, mesh)
    if mesh.held is None or not len(missing):
        return
    frames = mesh.table.frames
    turned = set() if frames is None else set(np.flatnonzero(np.any(frames != np.eye(3), axis=(1, 2))).tolist())
    held = {(node, component) for node, component in mesh.held.tolist() if node not in turned}
    loose = np.array([pair for pair in missing.tolist() if tuple(pair) not in held], dtype=np.int64).reshape(-1, 2)
    if len(loose):
        raise PartFileError(
            matrices.source,
            f"{len(loose)} motions of the mesh have no rows and no *BOUNDARY of {mesh.table.source.name} holds them "
            f"in global axes: {sentence_of(loose, mesh)}; matrices of another run, or motions tied by *EQUATION, *MPC, "
            "*RIGID BODY or *TRANSFORM with *BOUNDARY, which are not read: leave them out, the interfaces can tie them",
        )
