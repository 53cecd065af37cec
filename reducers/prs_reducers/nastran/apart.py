"""What runs in a child process: pyyeti's readers of OP4 and nas2cam files, after a check of the files' structure."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .fortran import Tokens, check_op4, check_op4_text, op2_blocks

EXTRA, NEEDS = ("pyyeti", "nastran"), "pyyeti.nastran"
READ_OP4, LIST_OP4, READ_NAS2CAM = (f"{__name__}:{name}" for name in ("read_op4", "list_op4", "read_nas2cam"))

Arrays = dict[str, NDArray[Any]]


def list_op4(path: Path) -> Arrays:
    """The shape (2,) of every matrix, by name in upper case. Raises ValueError."""
    op4 = _checked_op4(path)
    with _told("OP4"):
        names, sizes, _, _ = op4.dir(str(path), verbose=False)
    return {name.upper(): np.array(size, dtype=np.int64) for name, size in zip(names, sizes, strict=True)}


def read_op4(path: Path, stiffness: str, mass: str) -> Arrays:
    """Both matrices (n, n). Raises ValueError naming those that are there, when one is not."""
    op4 = _checked_op4(path)
    with _told("OP4"):
        names = [name.upper() for name in op4.dir(str(path), verbose=False)[0]]
    found = {}
    for kind, name in (("stiffness", stiffness.upper()), ("mass", mass.upper())):
        if names.count(name) != 1:
            raise ValueError(f"it has {names.count(name)} matrices {name}, expected one; it has {', '.join(names)}")
        with _told("OP4"):
            matrix, _, type_ = op4.load(str(path), [name.lower()], into="dct", sparse=False)[name.lower()]
        found[kind] = _real(matrix, name, int(type_))
    return found


def _real(matrix: NDArray[Any], name: str, kind: int) -> NDArray[Any]:
    if kind > 2:
        raise ValueError(f"{name} is complex, expected a real matrix")
    rows, columns = matrix.shape
    if rows != columns:
        raise ValueError(f"{name} is {rows}x{columns}, expected a square matrix")
    return np.asarray(matrix, dtype=float)


@contextmanager
def _told(kind: str) -> Iterator[None]:
    """What pyyeti makes of damaged files, said as what is wrong."""
    try:
        yield
    except MemoryError:
        raise
    except Exception as error:
        raise ValueError(f"cannot be read as {kind}: damaged, or of another kind ({error!r})") from error


def _checked_op4(path: Path) -> Any:
    data = path.read_bytes()
    if b"\0" in data[:64]:
        check_op4(data)
    else:
        check_op4_text(data)
    warnings.simplefilter("error", RuntimeWarning)  # so pyyeti tells of a file that ends too early
    from pyyeti.nastran import op4

    return op4


def read_nas2cam(op2: Path, op4: Path) -> Arrays:
    """Superelements (k,), and of each its points' rows, places, frames, matrices and eigenvalues. Raises ValueError."""
    for _ in op2_blocks(Tokens(op2.read_bytes())):
        pass
    _checked_op4(op4)
    from pyyeti.nastran import rdnas2cam

    with _told("a nas2cam pair"):
        nas = rdnas2cam(str(op2), str(op4))
    found: Arrays = {"superelements": np.asarray(nas["selist"], dtype=np.int64).reshape(-1, 2)}
    for number in found["superelements"][:, 0].tolist():
        if number not in nas["kaa"] or number not in nas["maa"]:
            raise ValueError(f"{op4.name} has no KAA and MAA of superelement {number}, which {op2.name} lists")
        part = _superelement(nas["uset"][number], nas["kaa"][number], nas["maa"][number])
        if number in nas["lambda"]:
            part["eigenvalues"] = np.asarray(nas["lambda"][number], dtype=float).ravel()
        found.update({f"{number} {name}": array for name, array in part.items()})
    return found


def _superelement(uset: Any, stiffness: Any, mass: Any) -> Arrays:
    """Rows of the a-set by point and component (0 for scalar points), and the grid points among them."""
    from pyyeti.nastran import mksetpv
    from pyyeti.nastran.n2p import rbgeom_uset

    kept = np.asarray(mksetpv(uset, "p", "a"), dtype=bool)
    points = uset.index.get_level_values("id").to_numpy()
    components = uset.index.get_level_values("dof").to_numpy()
    first = np.flatnonzero(components == 1)
    turned = np.asarray(rbgeom_uset(uset))[:, :3]
    return {
        "uset_rows": np.array(len(uset)),
        "points": points[kept],
        "components": components[kept],
        "grids": points[first],
        "coordinates": uset.iloc[first][["x", "y", "z"]].to_numpy(dtype=float),
        "frames": np.array([turned[at : at + 3].T for at in first]).reshape(-1, 3, 3),
        "systems": uset.iloc[first + 1]["x"].to_numpy(dtype=np.int64),
        "stiffness": np.asarray(stiffness, dtype=float),
        "mass": np.asarray(mass, dtype=float),
    }
