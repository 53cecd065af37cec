"""Superelements of an assembly in nas2cam form: points and sets in .op2, matrices in .op4."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from prs_model.arrays import FloatArray
from prs_model.errors import PartFileError
from prs_model.part_files import MODE, LabelledMatrices, NodeTable, read_apart
from prs_model.part_files.child_process import Arrays

from .apart import EXTRA, NEEDS, READ_NAS2CAM


@dataclass(frozen=True, eq=False)
class Superelement:
    """One superelement of an assembly.

    downstream: the one it is attached to. uset_rows: components of all its points. size: rows of its matrices.
    frequencies: (k,) [Hz], rising, that the solver found for it (negative for a negative eigenvalue), else empty.
    """

    number: int
    downstream: int
    uset_rows: int
    size: int
    frequencies: FloatArray


def superelements(op2: Path | str, op4: Path | str | None = None) -> tuple[Superelement, ...]:
    """The superelements of nas2cam files, the residual (0) among them. op4: of the same stem where it is not named.

    Raises PartFileError or MissingExtraError.
    """
    op2 = Path(op2)
    arrays = _arrays(op2, Path(op4) if op4 is not None else op2.with_suffix(".op4"))
    return tuple(
        Superelement(
            number=number,
            downstream=downstream,
            uset_rows=int(arrays[f"{number} uset_rows"]),
            size=len(arrays[f"{number} stiffness"]),
            frequencies=_frequencies(arrays.get(f"{number} eigenvalues", np.zeros(0))),
        )
        for number, downstream in arrays["superelements"].tolist()
    )


def read_nas2cam(op2: Path, op4: Path, wanted: int | None) -> tuple[LabelledMatrices, NodeTable, str]:
    """Matrices and points of one superelement, and the output systems of turned points.

    wanted: may be left out where there is one beside the residual. Raises PartFileError listing those that are there.
    """
    arrays = _arrays(op2, op4)
    known = arrays["superelements"][:, 0].tolist()
    number = _choice(op2, known, wanted)
    part = {name.split(" ", 1)[1]: array for name, array in arrays.items() if name.startswith(f"{number} ")}
    matrices = LabelledMatrices(
        source=op2,
        stiffness=_square(part["stiffness"]),
        mass=_square(part["mass"]),
        nodes=part["points"].astype(str),
        components=np.where(part["components"] == 0, MODE, part["components"] - 1),
    )
    table = NodeTable(op2, part["grids"].astype(str), part["coordinates"], part["frames"])
    pairs = zip(part["grids"].tolist(), part["systems"].tolist(), strict=True)
    kept = set(part["points"].tolist())
    return matrices, table, ", ".join(f"{grid} in {system}" for grid, system in pairs if system and grid in kept)


def _arrays(op2: Path, op4: Path) -> Arrays:
    if op2.is_file() and not op4.is_file():
        taken = f"it has no DMIG data blocks; of a nas2cam assembly there is an .op4 too, but no {op4.name} is there"
        raise PartFileError(op2, f"{taken}: name it with option 'op4', or export EXTSEOUT(.., MATOP4) instead")
    return read_apart(READ_NAS2CAM, op2, op4, extra=EXTRA, needs=NEEDS)


def _choice(path: Path, known: list[int], wanted: int | None) -> int:
    parts = [number for number in known if number]
    if wanted is None and len(parts) == 1:
        return parts[0]
    if wanted is None or wanted not in known:
        found = "found no 'superelement'" if wanted is None else f"superelement {wanted} is not there"
        listed = ", ".join(map(str, parts)) or "none"
        raise PartFileError(path, f"{found}, expected option 'superelement' to be one of {listed} (0 is the residual)")
    return wanted


def _square(matrix: NDArray[np.float64]) -> NDArray[np.float64]:
    """Diagonal matrices are stored as their diagonal."""
    return np.diag(matrix) if matrix.ndim == 1 else matrix


def _frequencies(eigenvalues: FloatArray) -> FloatArray:
    return np.sort(np.sign(eigenvalues) * np.sqrt(np.abs(eigenvalues)) / (2.0 * np.pi))
