"""ANSYS Mechanical (MAPDL): full matrices of a part, from its .full file or exported by APDL Math."""

from __future__ import annotations

import logging
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from prs_model.description.schema import Section
from prs_model.errors import PartFileError
from prs_model.finite_elements import FiniteElementModel
from prs_model.part_files import LabelledMatrices, NodeTable, full_model, read_text
from prs_model.plugins import PartRequest, Reducer

from ..meshes.mesh_agreement import check_against_mesh
from ..tables.mtx import is_mtx, parse_mtx
from .full_file import is_full, load_full, read_full
from .harwell_boeing import parse_harwell_boeing
from .node_list import read_nodes
from .row_map import read_row_map

__all__ = ["AnsysOptions", "AnsysReducer", "load_full"]


NO_PLACES = (
    "does not say where its nodes are: name a file beside it as 'coordinates', an archive (CDWRITE,DB,part,cdb), a "
    "listing of NLIST, or a node table exported from Workbench"
)

logger = logging.getLogger("prs_model")


class AnsysOptions(Section):
    """Files beside the source, relative to its folder.

    coordinates: where the nodes are, which no matrix file says: an archive (.cdb), a listing of NLIST, or a node table
    of Workbench. mass, map: for exported matrices, the mass and what the rows are (HBMAT's .mapping, or the BACK vector
    as MMF).
    """

    coordinates: str | None = None
    mass: str | None = None
    map: str | None = None


class AnsysReducer(Reducer[AnsysOptions]):
    """Source: a .full file (K, M and rows in one), or a stiffness of ``*EXPORT,..,MMF`` or HBMAT with `mass` and `map`.

    DOFs are in the nodes' own axes, which are turned to the body's where `coordinates` has their angles. DOFs that were
    constrained have no rows: such a part is held to the ground, and rows in another order show only against the
    elements of an archive; else export it free and clamp it here.
    """

    description: ClassVar[str] = "ANSYS: .full, or Matrix Market and Harwell-Boeing exports, with a list of nodes"
    Options: ClassVar[type[Section]] = AnsysOptions
    gives = "full"
    units = "asked"

    def read(self, part: PartRequest[AnsysOptions]) -> FiniteElementModel:
        """The full matrices; node components of an archive are node sets. Raises PartFileError."""
        if part.options.coordinates is None:
            raise PartFileError(part.path, NO_PLACES)
        listed, units = read_nodes(part.path.parent / part.options.coordinates), part.file_units
        table = listed.table
        listed.check_units(units)
        matrices, held = read_full(part.path) if is_full(part.path) else (self._exported(part), np.zeros(0, dtype=int))
        _warn_of_strangers(table, np.concatenate([matrices.nodes, held]), part.path)
        sets = {name: table.places(np.array(nodes), table.source) for name, nodes in listed.components.items()}
        model = full_model(matrices, table, units, node_sets=sets)
        if listed.mesh is not None:
            check_against_mesh(model, listed.mesh, matrices)
        return model

    def files(self, part: PartRequest[AnsysOptions]) -> tuple[Path, ...]:
        """The source, then the files that the options name."""
        named = (part.options.mass, part.options.map, part.options.coordinates)
        return (part.path, *(part.path.parent / name for name in named if name is not None))

    def _exported(self, part: PartRequest[AnsysOptions]) -> LabelledMatrices:
        options, folder = part.options, part.path.parent
        if options.mass is None or options.map is None:
            raise PartFileError(part.path, "is an exported matrix: name 'mass' and 'map' in its options too")
        stiffness = read_matrix(part.path)
        n = stiffness.shape[0]
        mass = read_matrix(folder / options.mass)
        nodes, components = read_row_map(folder / options.map, n)
        return LabelledMatrices(part.path, stiffness, mass, nodes, components)


def _warn_of_strangers(table: NodeTable, nodes: NDArray[Any], path: Path) -> None:
    strangers = np.setdiff1d(table.labels, nodes)
    if len(strangers):
        some = f"{strangers[0]}" + " .." * (len(strangers) > 1)
        what = "have no rows in %s: constrained, or is it the list of another part?"
        logger.warning(f"%s: %d of its nodes (%s) {what}", table.source.name, len(strangers), some, path.name)


def read_matrix(path: Path) -> csr_array:
    """A symmetric matrix in Matrix Market or Harwell-Boeing format, both triangles filled. Raises PartFileError."""
    text = read_text(path)
    return parse_mtx(text, path) if is_mtx(text) else parse_harwell_boeing(text, path)
