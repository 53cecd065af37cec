"""EXTSEOUT(DMIGOP2): files as they are documented, and a real one with DMIG records."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.testing.element import plain_element
from prs_reducers import nastran
from tests.reducers.writers.extdb import END, write_extdb

UNITS = "m-N-kg-s"


def test_what_is_written_as_documented_is_read(tmp_path: Path) -> None:
    element = plain_element()
    found = prs.read_part("nastran", write_extdb(tmp_path / "part.op2", element), units=UNITS)
    found.check()
    assert found.nodes == element.nodes
    assert found.n_modes == element.n_modes
    for name in ("stiffness", "mass", "positions", "motions"):
        assert np.array_equal(getattr(found, name), getattr(element, name))
    assert nastran.matrices(tmp_path / "part.op2") == {"MATK": (element.size,) * 2, "MATM": (element.size,) * 2}


def test_coarse_places_are_told_and_replaced(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    """In single precision 0.1 is off by 1e-9, which the gate lets pass; GRID entries put that right."""
    element = plain_element()
    path = write_extdb(tmp_path / "part.op2", element, double=False)
    coarse = prs.read_part("nastran", path, units=UNITS)
    assert np.abs(coarse.positions - element.positions).max() > 1e-10
    assert "part.op2: its points have places of seven digits (single precision)" in caplog.text
    caplog.clear()
    places = zip(element.nodes, element.positions, strict=True)
    (tmp_path / "grids.bdf").write_text(
        "".join(
            f"GRID,{node},,{x!r},{y!r},{z!r}\n"
            for node, (x, y, z) in ((node, map(float, place)) for node, place in places)
        )
    )
    found = prs.read_part("nastran", path, units=UNITS, grids="grids.bdf")
    assert np.array_equal(found.positions, element.positions)
    assert not caplog.text


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (["GEOM1EX", "GEOM2EX", "MATK"], "XSOP2DIR names 3 data blocks, but 4 are there: export EXTSEOUT.*MATOP4"),
        (["GEOM1EX", "GEOM2EX", "MATM", "MATP"], "it has no stiffness matrix MATK, only MATM, MATP"),
        (["GEOM1EX", "GEOM2EX", "MATK", "MATK"], "two matrices MATK"),
    ],
)
def test_a_directory_that_is_another(tmp_path: Path, names: list[str], said: str) -> None:
    path = write_extdb(tmp_path / "part.op2", plain_element(), directory=names)
    with pytest.raises(prs.PartFileError, match=said):
        prs.read_part("nastran", path, units=UNITS)


@pytest.mark.parametrize(
    ("end", "said"),
    [
        (b"", "does not end with its end mark"),
        (END + bytes(4), r"ends within column -1\.-1"),
        (END + END, "does not end with its end mark"),
    ],
)
def test_matrices_end_with_their_end_mark(tmp_path: Path, end: bytes, said: str) -> None:
    path = write_extdb(tmp_path / "part.op2", plain_element(), end=end)
    with pytest.raises(prs.PartFileError, match=said):
        prs.read_part("nastran", path, units=UNITS)


def test_a_grid_point_is_no_mode(tmp_path: Path) -> None:
    element = plain_element()
    path = write_extdb(tmp_path / "part.op2", element)
    data = path.read_bytes()
    path.write_bytes(data.replace(struct.pack("<2i", 23, 6), struct.pack("<2i", 23, 0)))
    with pytest.raises(prs.PartFileError, match=r"row 23\.0 belongs to no SPOINT entry"):
        prs.read_part("nastran", path, units=UNITS)


def test_a_cut_file_at_every_place(tmp_path: Path) -> None:
    data = write_extdb(tmp_path / "part.op2", plain_element()).read_bytes()
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
