"""ANSYS .full files: the assembled matrices, with node number and component of each row, but without coordinates."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import coo_array, csr_array

from prs_model.arrays import IntArray
from prs_model.errors import PartFileError
from prs_model.part_files import LabelledMatrices, read_apart
from prs_model.part_files.text import file_access

EXTRA = ("ansys-mapdl-reader", "ansys")


def load_full(path: str | Path) -> LabelledMatrices:
    """Stiffness and mass of a .full file in its own units, rows by node number and component, as the solver has them.

    Constrained DOFs have no rows. Raises PartFileError for a file that is damaged, unsymmetric, with a lumped mass, or
    with other DOFs than displacements and rotations; MissingExtraError without ansys-mapdl-reader.
    """
    return read_full(Path(path))[0]


def read_full(path: Path) -> tuple[LabelledMatrices, IntArray]:
    """As `load_full`, and the nodes that have constrained DOFs."""
    found = read_apart(f"{__name__}:read_arrays", path, extra=EXTRA, needs="ansys.mapdl.reader")
    n = len(found["nodes"])
    matrices = LabelledMatrices(
        source=path,
        stiffness=_both_triangles(found, "k", n),
        mass=_both_triangles(found, "m", n),
        nodes=found["nodes"],
        components=found["components"],
    )
    return matrices, found["held"]


def read_arrays(path: Path) -> dict[str, NDArray[Any]]:
    """Triplets of both upper triangles and what the rows are. Raises ValueError; may crash on damaged bytes."""
    from ansys.mapdl.reader.full import FullFile

    try:
        file = FullFile(path)
    except NotImplementedError as error:
        raise ValueError(f"{error}: solve with a consistent mass and symmetric matrices") from error
    except ValueError as error:
        raise ValueError("its header cannot be read: damaged, or no .full file") from error
    header = file._header
    _check_header(header, path.stat().st_size)
    rows, stiffness, mass = file.load_km(sort=False)
    if stiffness is None or mass is None:
        raise ValueError("has no stiffness or no mass: write it in a modal analysis (ANTYPE,MODAL and WRFULL)")
    kept = _unconstrained(rows, file.const)
    _check_diagonal(file.read_record(header["ptrDIAGK"]), stiffness, kept, "stiffness")
    _check_diagonal(file.read_record(header["ptrDIAGM"]), mass, kept, "mass")
    arrays: dict[str, NDArray[Any]] = {
        "nodes": rows[kept, 0].astype(np.int64),
        "held": np.unique(file.const[:, 0]).astype(np.int64),
        "components": _components(path, rows[kept, 1], int(header["numdof"])),
    }
    for name, matrix in (("k", stiffness), ("m", mass)):
        entries = matrix.tocsr()[kept][:, kept].tocoo()
        arrays |= {f"{name}_rows": entries.row, f"{name}_columns": entries.col, f"{name}_data": entries.data}
    return arrays


def _check_header(header: dict[str, Any], size: int) -> None:
    """The header says where the file ends; it is filled up to whole blocks beyond that."""
    if header["fun04"] != -4 or not 0 < header["neqn"] * 4 < size:
        raise ValueError(f"is no .full file with assembled matrices ({header['neqn']} equations said)")
    if header["ptrEND"] * 4 > size:
        raise ValueError(f"has {size} bytes, its header says {header['ptrEND'] * 4}: cut off")


def _check_diagonal(said: NDArray[Any], matrix: Any, kept: NDArray[Any], name: str) -> None:
    """The file holds both diagonals a second time, with something else where a DOF is constrained."""
    found = matrix.diagonal()
    if len(said) < len(found) or np.any(np.abs(said[: len(found)] - found)[kept] > 1e-9 * np.abs(found).max(initial=0)):
        raise ValueError(f"the diagonal of the {name} is not the one that the file says apart: damaged")


def _unconstrained(rows: NDArray[Any], constrained: NDArray[Any]) -> NDArray[Any]:
    held = {(int(node), int(dof)) for node, dof in constrained}
    return np.array([at for at, (node, dof) in enumerate(rows.tolist()) if (node, dof) not in held], dtype=np.int64)


def _components(path: Path, places: NDArray[Any], count: int) -> NDArray[Any]:
    """0..5: the third record of the file lists which DOFs its nodes have, 1..6 for UX..ROTZ."""
    from ansys.mapdl.reader.common import read_table

    with path.open("rb") as file:
        for _ in range(2):
            read_table(file, skip=True)
        known = read_table(file)[:count]
    if len(known) < count or np.any(known < 1) or np.any(known > 6) or np.any(places >= count):
        raise ValueError(f"its DOFs are {known.tolist()}, expected 1..6 (UX, UY, UZ, ROTX, ROTY, ROTZ)")
    return np.asarray(known[places] - 1, dtype=np.int64)


def _both_triangles(found: dict[str, NDArray[Any]], name: str, n: int) -> csr_array:
    rows, columns, data = (found[f"{name}_{part}"] for part in ("rows", "columns", "data"))
    off = rows != columns
    places = np.concatenate([rows, columns[off]]), np.concatenate([columns, rows[off]])
    return csr_array(coo_array((np.concatenate([data, data[off]]), places), shape=(n, n)))


def is_full(path: Path) -> bool:
    """Whether a file is binary, as .full is. Raises PartFileError when it cannot be read."""
    with file_access(path, "read"), path.open("rb") as file:
        head = file.read(400)
    if not head:
        raise PartFileError(path, "is empty")
    return b"\0" in head
