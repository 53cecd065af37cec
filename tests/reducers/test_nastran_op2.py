"""EXTSEOUT(DMIGOP2): a tiny writer of the documented records, and a real file with DMIG records."""

from __future__ import annotations

import struct
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.reduction import SuperElement
from prs_model.testing.element import plain_element
from prs_reducers import nastran

UNITS = "m-N-kg-s"
GRID, GRID_DOUBLE, CORD2R = (4501, 45, 1), (4501, 45, 1120001), (2101, 21, 8)
SPOINT, DMIG = (5551, 49, 105), (114, 1, 120)


def record(data: bytes) -> bytes:
    return struct.pack("<i", len(data)) + data + struct.pack("<i", len(data))


def key(*values: int) -> bytes:
    return b"".join(record(struct.pack("<i", value)) for value in values)


def block(name: str, records: Iterable[bytes]) -> bytes:
    """Name, trailer, then records numbered from -2, each of one chunk, and an empty last one."""
    out = key(2) + record(name.ljust(8).encode()) + key(-1, 7) + record(struct.pack("<7i", 101, 0, 0, 0, 0, 0, 0))
    number = -2
    for data in records:
        out += key(number, 1, 0, len(data) // 4) + record(data)
        number -= 1
    return out + key(number, 1, 0, 0)


def dmig(matrix: np.ndarray, dofs: list[tuple[int, int]]) -> bytes:
    out = struct.pack("<3i8s7i", *DMIG, b"EXTDB   ", 0, 6, 2, 2, 0, 0, len(matrix))
    for column, label in enumerate(dofs):
        out += struct.pack("<2i", *label)
        for row in range(column, len(dofs)):
            if matrix[row, column]:
                out += struct.pack("<2id", *dofs[row], matrix[row, column])
        out += struct.pack("<2i", -1, -1)
    return out + struct.pack("<2i", -1, -1)


def write(path: Path, element: SuperElement, *, directory: Iterable[str] | None = None, double: bool = True) -> Path:
    layout, head = ("<2i3d3i", GRID_DOUBLE) if double else ("<2i3f3i", GRID)
    places = zip(element.nodes, element.positions, strict=True)
    grids = b"".join(struct.pack(layout, int(node), 0, *place, 0, 0, 0) for node, place in places)
    modes = [900 + index for index in range(element.n_modes)]
    dofs = [(int(node), component) for node in element.nodes for component in range(1, 7)] + [
        (mode, 0) for mode in modes
    ]
    system = struct.pack("<4i9f", 5, 1, 2, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0)
    blocks = {
        "GEOM1EX": [b"GEOM1   ", struct.pack("<3i", *CORD2R) + system, struct.pack("<3i", *head) + grids],
        "GEOM2EX": [b"GEOM2   ", struct.pack("<3i", *SPOINT) + struct.pack(f"<{len(modes)}i", *modes)],
        "MATK": [b"EXTDB   ", dmig(element.stiffness, dofs)],
        "MATM": [b"EXTDB   ", dmig(element.mass, dofs)],
    }
    names = list(directory) if directory is not None else list(blocks)
    listed = [name.ljust(8).encode() for name in ("XSOP2DIR", "PVT0", *names)]
    head_ = key(3) + record(struct.pack("<3i", 1, 2, 26)) + key(7) + record(b"NASTRAN FORT TAPE ID CODE - ")
    head_ += key(2) + record(b"NX2019  ") + key(-1, 0)
    data = head_ + block("XSOP2DIR", listed) + block("PVT0", [b"PVT0    "])
    path.write_bytes(data + b"".join(block("EXTDB", records) for records in blocks.values()) + key(0))
    return path


def test_what_is_written_as_documented_is_read(tmp_path: Path) -> None:
    element = plain_element()
    found = prs.read_part("nastran", write(tmp_path / "part.op2", element), units=UNITS)
    found.check()
    assert found.nodes == element.nodes
    assert found.n_modes == element.n_modes
    for name in ("stiffness", "mass", "positions", "motions"):
        assert np.array_equal(getattr(found, name), getattr(element, name))
    assert nastran.matrices(tmp_path / "part.op2") == {"MATK": (element.size,) * 2, "MATM": (element.size,) * 2}


def test_coarse_places_are_refused_and_replaced(tmp_path: Path) -> None:
    """In single precision 0.1 is off by 1e-9, and K moves as a rigid body no more; GRID entries put that right."""
    element = plain_element()
    path = write(tmp_path / "part.op2", element, double=False)
    coarse = prs.read_part("nastran", path, units=UNITS)
    assert np.abs(coarse.positions - element.positions).max() > 1e-10
    places = zip(element.nodes, element.positions, strict=True)
    (tmp_path / "grids.bdf").write_text(
        "".join(
            f"GRID,{node},,{x!r},{y!r},{z!r}\n"
            for node, (x, y, z) in ((node, map(float, place)) for node, place in places)
        )
    )
    found = prs.read_part("nastran", path, units=UNITS, grids="grids.bdf")
    assert np.array_equal(found.positions, element.positions)


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (["GEOM1EX", "GEOM2EX", "MATK"], "XSOP2DIR names 3 data blocks, but 4 are there: export EXTSEOUT.*MATOP4"),
        (["GEOM1EX", "GEOM2EX", "MATM", "MATP"], "unknown matrix 'MATK'"),
        (["GEOM1EX", "GEOM2EX", "MATK", "MATK"], "two matrices MATK"),
    ],
)
def test_a_directory_that_is_another(tmp_path: Path, names: list[str], said: str) -> None:
    path = write(tmp_path / "part.op2", plain_element(), directory=names)
    with pytest.raises(prs.PartFileError, match=said):
        prs.read_part("nastran", path, units=UNITS)


def test_a_cut_file_at_every_place(tmp_path: Path) -> None:
    data = write(tmp_path / "part.op2", plain_element()).read_bytes()
    for cut in range(0, len(data) - 12, 997):
        (tmp_path / "cut.op2").write_bytes(data[:cut])
        with pytest.raises(prs.PartFileError):
            prs.read_part("nastran", tmp_path / "cut.op2", units=UNITS)


def test_a_real_file_with_dmig_records() -> None:
    """pyyeti's test files, where they are installed: an OP2 and the punch of the same run hold the same numbers."""
    pyyeti = pytest.importorskip("pyyeti")
    folder = Path(pyyeti.__file__).parent / "tests" / "nastran_dmig_data"
    if not (folder / "matrix.op2").is_file() or not (folder / "matrix_factory.pch").is_file():
        pytest.skip("pyyeti is installed without its test files")
    from prs_reducers.nastran.extdb import external
    from prs_reducers.nastran.punch import punch_matrices

    binary, text = external(folder / "matrix.op2").matrices, punch_matrices(folder / "matrix_factory.pch")
    for name, matrix in text.items():
        other = binary[f"M{name}"].entries
        assert matrix.entries.keys() == other.keys()
        assert all(abs(other[place] - value) < 1e-9 * max(1.0, abs(value)) for place, value in matrix.entries.items())
