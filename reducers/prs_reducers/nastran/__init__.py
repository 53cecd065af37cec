"""Nastran's reduced parts: EXTSEOUT in OP4 or OP2, nas2cam assemblies, DMIG punches (OptiStruct's too)."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

from prs_model.description.schema import Section
from prs_model.description.units import Units
from prs_model.errors import PartFileError
from prs_model.finite_elements import FiniteElementModel
from prs_model.part_files import LabelledMatrices, NodeTable, full_model, read_apart, super_element
from prs_model.plugins import PartRequest, Reducer
from prs_model.reduction import SuperElement

from .apart import EXTRA, LIST_OP4, NEEDS
from .extdb import external, is_external, read_extdb
from .matop4 import check_beginning, read_matop4
from .nas2cam import Superelement, read_nas2cam, superelements
from .notes import notes_of, system
from .punch import punch_matrices, read_punch

__all__ = ["NastranOptions", "NastranReducer", "Superelement", "matrices", "superelements"]

MOST_ROWS = 5000  # of a reduced part, whose matrices are dense
OP4, OP2 = ".op4", ".op2"
PUNCH = (".pch", ".dmig", ".bdf", ".dat", ".nas", ".fem")
NAMES = {OP4: ("KXX", "MXX"), OP2: ("MATK", "MATM"), **dict.fromkeys(PUNCH, ("KAAX", "MAAX"))}
TAKEN = {OP4: {"asm", "pch"}, OP2: {"op4", "superelement", "grids"}, **{suffix: {"grids"} for suffix in PUNCH}}


class NastranOptions(Section):
    """Companion files are named relative to the source's folder.

    asm, pch: companions of an .op4 of EXTSEOUT(MATOP4), else those of the same stem. op4: companion of an .op2 in
    nas2cam form, else that of the same stem. superelement: which one of such an assembly (0 is the residual).
    grids: bulk data file with the GRID and CORD2 entries of a punch that has none, or of an OP2 export.
    stiffness, mass: names of the matrices, else KXX, MXX (.op4), KAAX, MAAX (punch), MATK, MATM (.op2).
    modal_basis: whether the modal coordinates are what Craig-Bampton promises, mass-normalised and not coupled
    elastically to the points, which is then checked; say 'other' where a run had free points (CSET, BNDFREE).
    full: the matrices are those of the whole model, as PARAM,EXTOUT,DMIGPCH writes without ASET; it is reduced here.
    """

    asm: str | None = None
    pch: str | None = None
    op4: str | None = None
    superelement: int | None = None
    grids: str | None = None
    stiffness: str | None = None
    mass: str | None = None
    modal_basis: Literal["fixed-interface", "other"] = "fixed-interface"
    full: bool = False


class NastranReducer(Reducer[NastranOptions]):
    """Nastran's files do not say their units; those that this program wrote do, in a comment."""

    description: ClassVar[str] = (
        "Nastran superelement: EXTSEOUT .op4 or .op2, nas2cam .op2, DMIG punch (also OptiStruct)"
    )
    Options: ClassVar[type[Section]] = NastranOptions
    gives = "either"
    units = "optional"
    writes = (".op4", ".pch")

    def read(self, part: PartRequest[NastranOptions]) -> FiniteElementModel | SuperElement:
        """Read the part. Scalar points are modal coordinates; a grid's motions are in its own output system.

        Raises PartFileError or MissingExtraError.
        """
        _check_source(part)
        units = _units(part)
        matrices, table, turned = _read(part)
        said = {"output systems": turned} if turned else {}
        if part.options.full:
            return full_model(matrices, _with_rows(table, matrices), units, provenance=said)
        if len(matrices.nodes) > MOST_ROWS and not np.any(matrices.is_mode):
            found = f"it has {len(matrices.nodes)} rows and no modal coordinates"
            raise PartFileError(part.path, f"{found}, like a whole model: say 'full: true' to have it reduced here")
        modal = part.options.modal_basis == "fixed-interface" and bool(np.any(matrices.is_mode))
        modes = "fixed-interface" if modal else ""
        return super_element(matrices, table, units, modes=modes, provenance=said)

    def files(self, part: PartRequest[NastranOptions]) -> tuple[Path, ...]:
        """The source and its companions."""
        suffix = _suffix(part.path)
        if suffix == OP4:
            return (part.path, *_companions(part))
        if suffix == OP2:
            return (part.path, _beside(part, part.options.op4, OP4), *_grids(part))
        return (part.path, *_grids(part))

    def write(self, element: SuperElement, path: Path, units: Units) -> None:
        """Write .op4 with its .asm and .pch, or a DMIG .pch. Raises PartFileError or MissingExtraError."""
        from .write import write_matop4, write_punch

        (write_matop4 if path.suffix.lower() == OP4 else write_punch)(element, path, units)


def matrices(path: Path | str) -> dict[str, tuple[int, int]]:
    """Rows and columns of every matrix in an .op4 file, a DMIG punch, or an .op2 file, by name.

    Of DMIG, rows and columns that have entries are counted. Of a nas2cam assembly there are a stiffness and a mass of
    each superelement, such as ``KAA 101``. Raises PartFileError or MissingExtraError.
    """
    path = Path(path)
    if _suffix(path) == OP4:
        sizes = read_apart(LIST_OP4, path, extra=EXTRA, needs=NEEDS)
        return {name: (int(size[0]), int(size[1])) for name, size in sizes.items()}
    if _suffix(path) == OP2 and not is_external(path):
        return {f"{name} {each.number}": (each.size,) * 2 for each in superelements(path) for name in ("KAA", "MAA")}
    found = external(path).matrices if _suffix(path) == OP2 else punch_matrices(path)
    return {name: matrix.shape for name, matrix in found.items()}


def _read(part: PartRequest[NastranOptions]) -> tuple[LabelledMatrices, NodeTable, str]:
    suffix, options = _suffix(part.path), part.options
    names = options.stiffness or NAMES[suffix][0], options.mass or NAMES[suffix][1]
    grids = next(iter(_grids(part)), None)
    if suffix == OP4:
        return read_matop4(part.path, _present(part), *names)
    if suffix == OP2 and not is_external(part.path):
        return read_nas2cam(part.path, _beside(part, options.op4, OP4), options.superelement)
    read = read_extdb if suffix == OP2 else read_punch
    return *read(part.path, grids, *names), ""


def _with_rows(table: NodeTable, matrices: LabelledMatrices) -> NodeTable:
    """Those points that the matrices have rows of: held ones have none."""
    kept = np.isin(table.labels, matrices.nodes)
    frames = None if table.frames is None else table.frames[kept]
    return NodeTable(table.source, table.labels[kept], table.coordinates[kept], frames)


def _suffix(path: Path) -> str:
    """The suffix, which says what the file is. Raises PartFileError for one that is none of ours."""
    suffix = path.suffix.lower()
    if suffix not in NAMES:
        hint = ": give the .op4 that it belongs to" if suffix == ".asm" else ""
        raise PartFileError(path, f"has suffix '{suffix}', expected one of {', '.join(NAMES)}{hint}")
    return suffix


def _check_source(part: PartRequest[NastranOptions]) -> None:
    """Raises PartFileError for a file that is not there or no part of its own, and for options of other files."""
    suffix = _suffix(part.path)
    if suffix == OP4:
        check_beginning(part.path)
    for name in ("asm", "pch", "op4", "superelement", "grids"):
        if getattr(part.options, name) is not None and name not in TAKEN[suffix]:
            raise PartFileError(part.path, f"option '{name}' says nothing of a {suffix} file: leave it out")


def _units(part: PartRequest[NastranOptions]) -> Units:
    """What the request says, or a file that this program wrote. Raises PartFileError when they differ, or none says."""
    units, sayer = part.units, "'units'"
    for path in _texts(part):
        written = notes_of(path).units
        if units is not None and written is not None and units != written:
            raise PartFileError(path, f"is in {system(written)}, and {sayer} says {system(units)}: correct one of them")
        if units is None and written is not None:
            units, sayer = written, path.name
    return part.file_units if units is None else units


def _texts(part: PartRequest[NastranOptions]) -> tuple[Path, ...]:
    """The files that are bulk data. Raises PartFileError."""
    suffix = _suffix(part.path)
    if suffix == OP4:
        return _present(part)
    return _grids(part) if suffix == OP2 else (part.path, *_grids(part))


def _beside(part: PartRequest[NastranOptions], option: str | None, suffix: str) -> Path:
    return part.path.with_suffix(suffix) if option is None else part.path.parent / option


def _grids(part: PartRequest[NastranOptions]) -> tuple[Path, ...]:
    return () if part.options.grids is None else (part.path.parent / part.options.grids,)


def _companions(part: PartRequest[NastranOptions]) -> tuple[Path, Path]:
    return _beside(part, part.options.pch, ".pch"), _beside(part, part.options.asm, ".asm")


def _present(part: PartRequest[NastranOptions]) -> tuple[Path, ...]:
    """The companions that are named or there. Raises PartFileError when there is none."""
    named = part.options.pch, part.options.asm
    both = zip(_companions(part), named, strict=True)
    present = tuple(path for path, option in both if option is not None or path.exists())
    if not present:
        listed = " or ".join(path.name for path in _companions(part))
        raise PartFileError(
            part.path, f"found no {listed} beside it, which say what the rows are: name them with options"
        )
    return present
