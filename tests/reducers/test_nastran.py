"""The nastran reducer on real exports (EXTSEOUT(MATOP4), CSUPER, nas2cam assemblies), by independent figures."""

from __future__ import annotations

import shutil
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

import prs_model as prs
from prs_model.reduction import SuperElement
from prs_reducers import nastran
from tests.superelements import DATA, needs_data, reference

pytest.importorskip("pyyeti")

AS_WRITTEN = "m-N-kg-s"  # passes numbers through
EXPORTS = ("nastran_extseout/outboard", "nastran_extseout/inboard", "nastran_csuper/inboard")
NAS2CAM = DATA / "nastran_extseout" / "nas2cam.op2"
ROUND_OFF = 1e-3  # Hz, of the rigid modes


@cache
def read(source: Path, **options: object) -> SuperElement:
    found = prs.read_part("nastran", source, units=AS_WRITTEN, **options)
    assert isinstance(found, SuperElement)
    return found


def frequencies(stiffness: np.ndarray, mass: np.ndarray) -> np.ndarray:
    """All of them, also beside massless motions: the inverse problem, shifted."""
    shift = 10.0
    inverse = eigh(mass, stiffness + shift * mass, eigvals_only=True)
    values = 1.0 / inverse[inverse > 1e-11 * inverse[-1]] - shift
    return np.sort(np.sign(values) * np.sqrt(np.abs(values)) / (2.0 * np.pi))


@needs_data
@pytest.mark.parametrize("record", EXPORTS)
class TestExports:
    def test_points_and_rows(self, record: str) -> None:
        expected, element = reference(record), read(DATA / f"{record}.op4")
        assert [element.size, element.size] == expected["size"]
        assert element.size == expected["n_uset_rows"] == expected["kept_dof"]
        assert dict(zip(element.nodes, element.positions.tolist(), strict=True)) == expected["grids"]
        assert (element.size - element.n_modes, element.n_modes) == (expected["n_boundary_dof"], expected["n_modal"])
        first, last = expected["spoints_first_last"]
        assert (element.labels[-element.n_modes], element.labels[-1]) == (f"mode {first}", f"mode {last}")
        turned = {grid: system for grid, system in expected["grid_disp_coord"].items() if system}
        assert element.provenance["output systems"] == ", ".join(f"{g} in {s}" for g, s in turned.items())

    def test_output_frame_of_grid_11(self, record: str) -> None:
        """CORD2R 10 has z along the body's x, and x along its y."""
        element = read(DATA / f"{record}.op4")
        frame = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
        rows = [element.labels.index(f"11.{axis}") for axis in ("ux", "uy", "uz")]
        assert np.array_equal(element.motions[element.node("11")][:3, rows], frame)
        assert np.array_equal(element.motions[element.node("19")][:3, 12:15], np.eye(3))

    def test_mass_and_centre(self, record: str) -> None:
        expected, element = reference(record), read(DATA / f"{record}.op4")
        phi = element.rigid_body_modes()
        rigid = phi.T @ element.mass @ phi
        assert np.diag(rigid)[:3] == pytest.approx(expected["mass_xyz"], rel=1e-14)
        assert np.diag(rigid)[3:] == pytest.approx(expected["inertia_about_origin_diag"], rel=1e-13)
        assert element.mass_properties().centre == pytest.approx(expected["cg_from_rb"], rel=1e-9)
        residual = np.linalg.norm(element.stiffness @ phi) / np.linalg.norm(element.stiffness) / np.linalg.norm(phi)
        assert residual < 10.0 * expected["K_rb_ratio"]

    def test_modal_block(self, record: str) -> None:
        expected, element = reference(record), read(DATA / f"{record}.op4")
        K, M, b = element.stiffness, element.mass, element.size - element.n_modes
        fixed = np.sqrt(np.diag(K)[b:]) / (2.0 * np.pi)
        count = len(expected["fixed_interface_freq_hz"])
        assert np.sort(fixed)[:count] == pytest.approx(expected["fixed_interface_freq_hz"], rel=1e-14)
        assert np.array_equal(M[b:, b:], np.eye(element.n_modes))
        assert not np.any(K[:b, b:])
        assert np.array_equal(K[b:, b:], np.diag(np.diag(K)[b:]))

    def test_free_frequencies_and_the_singular_mass(self, record: str) -> None:
        expected, element = reference(record), read(DATA / f"{record}.op4")
        found = frequencies(np.array(element.stiffness), np.array(element.mass))[:16]
        assert np.all(np.abs(found[:6]) < ROUND_OFF)
        assert found[6:] == pytest.approx(expected["free_free_freq_hz_first16"][6:16], rel=1e-9)
        lowest, *_, highest = np.linalg.eigvalsh(element.mass)
        assert (lowest > 1e-12 * highest) == expected["M_positive_definite"]

    def test_matrices_of_the_file(self, record: str) -> None:
        found = nastran.matrices(DATA / f"{record}.op4")
        expected = {name.upper(): tuple(shape) for name, shape in reference(record)["matrices_in_file"].items()}
        assert {name: shape for name, shape in found.items() if shape != (1, 1)} == expected


@needs_data
class TestAssembly:
    def test_its_op4_names_the_op2(self) -> None:
        for options in ({}, {"superelement": 101}):
            with pytest.raises(prs.PartFileError, match=r"the \.op4 of a nas2cam assembly: give nas2cam\.op2"):
                read(NAS2CAM.with_suffix(".op4"), **options)

    def test_its_matrices(self) -> None:
        sizes = {int(number): tuple(size) for number, size in reference("nastran_extseout/nas2cam")["kaa"].items()}
        expected = {f"{name} {number}": size for number, size in sizes.items() for name in ("KAA", "MAA")}
        assert nastran.matrices(NAS2CAM) == expected

    def test_superelements_and_the_solvers_frequencies(self) -> None:
        expected = reference("nastran_extseout/nas2cam")
        found = {each.number: each for each in nastran.superelements(NAS2CAM)}
        assert [[each.number, each.downstream] for each in found.values()] == expected["selist"]
        assert {str(number): each.uset_rows for number, each in found.items()} == expected["uset_rows"]
        for shapes in (expected["kaa"], expected["maa"]):
            assert {str(number): [each.size, each.size] for number, each in found.items()} == shapes
        listed = expected["lambda_freq_hz_first10"]["0"]
        assert found[0].frequencies[: len(listed)] == pytest.approx(listed, rel=1e-12)
        assert found[101].frequencies.size == found[102].frequencies.size == 0

    @pytest.mark.parametrize(("number", "record"), [(101, EXPORTS[0]), (102, EXPORTS[1])])
    def test_a_superelement_is_the_export_that_it_was_assembled_from(self, number: int, record: str) -> None:
        """Its rows stand in another order, modes first."""
        one, other = read(NAS2CAM, superelement=number), read(DATA / f"{record}.op4")
        assert (one.nodes, one.labels) == (other.nodes, other.labels)
        for name in ("stiffness", "mass", "positions", "motions"):
            a, b = getattr(one, name), getattr(other, name)
            assert np.allclose(a, b, rtol=1e-9, atol=1e-13 * np.abs(b).max())

    def test_the_residual_is_the_assembly(self) -> None:
        element = read(NAS2CAM, superelement=0)
        element.check()
        found = frequencies(np.array(element.stiffness), np.array(element.mass))
        listed = reference("nastran_extseout/nas2cam")["recomputed_freq_hz_first12"]
        assert found[6 : len(listed)] == pytest.approx(listed[6:], rel=1e-9)

    def test_which_superelements_there_are_is_said(self) -> None:
        with pytest.raises(prs.PartFileError, match=r"superelement 7 is not there, .* one of 101, 102 "):
            read(NAS2CAM, superelement=7)

    def test_a_cut_op2_file_and_one_alone(self, tmp_path: Path) -> None:
        (tmp_path / "nas2cam.op2").write_bytes(NAS2CAM.read_bytes())
        with pytest.raises(prs.PartFileError, match=r"nas2cam\.op2: .*no nas2cam\.op4 is there: .*option 'op4'"):
            read(tmp_path / "nas2cam.op2", superelement=101)
        shutil.copy(NAS2CAM.with_suffix(".op4"), tmp_path)
        (tmp_path / "nas2cam.op2").write_bytes(NAS2CAM.read_bytes()[:-500])
        with pytest.raises(prs.PartFileError, match="truncated"):
            read(tmp_path / "nas2cam.op2", superelement=101)


@needs_data
class TestCompanions:
    @pytest.fixture
    def part(self, tmp_path: Path) -> Path:
        for suffix in (".op4", ".asm", ".pch"):
            shutil.copy(DATA / f"{EXPORTS[1]}{suffix}", tmp_path / f"part{suffix}")
            (tmp_path / f"part{suffix}").chmod(0o644)
        return tmp_path / "part.op4"

    def test_each_of_them_will_do(self, part: Path) -> None:
        whole = read(DATA / f"{EXPORTS[1]}.op4")
        for kept in (".asm", ".pch"):
            other = {".asm": ".pch", ".pch": ".asm"}[kept]
            part.with_suffix(other).rename(part.with_suffix(".away"))
            found = prs.read_part("nastran", part, units=AS_WRITTEN)
            assert found.labels == whole.labels
            assert np.array_equal(found.motions, whole.motions)
            part.with_suffix(".away").rename(part.with_suffix(other))

    def test_none(self, part: Path) -> None:
        for suffix in (".asm", ".pch"):
            part.with_suffix(suffix).unlink()
        with pytest.raises(prs.PartFileError, match=r"found no part\.pch or part\.asm beside it"):
            prs.read_part("nastran", part, units=AS_WRITTEN)
        with pytest.raises(prs.PartFileError, match=r"rows\.pch: there is no such file"):
            prs.read_part("nastran", part, units=AS_WRITTEN, pch="rows.pch")

    def test_those_of_another_part(self, part: Path) -> None:
        shutil.copy(DATA / f"{EXPORTS[0]}.pch", part.with_suffix(".pch"))
        with pytest.raises(prs.PartFileError, match=r"part\.pch and part\.asm name different points"):
            prs.read_part("nastran", part, units=AS_WRITTEN)
        part.with_suffix(".asm").unlink()
        with pytest.raises(prs.PartFileError, match=r"KXX is 32x32, but part\.pch names 46 rows"):
            prs.read_part("nastran", part, units=AS_WRITTEN)

    def test_a_digit_that_differs_between_the_two(self, part: Path) -> None:
        text = part.with_suffix(".asm").read_text().replace(" 0.300000000E+03", " 0.310000000E+03", 1)
        part.with_suffix(".asm").write_text(text)
        with pytest.raises(prs.PartFileError, match="differ in point"):
            prs.read_part("nastran", part, units=AS_WRITTEN)

    def test_a_matrix_that_was_not_written(self, part: Path) -> None:
        with pytest.raises(
            prs.PartFileError, match="BXX1 is 1x1, which stands for a matrix that the run did not write"
        ):
            prs.read_part("nastran", part, units=AS_WRITTEN, mass="BXX1")
        with pytest.raises(prs.PartFileError, match="it has 0 matrices MAA, expected one; it has KXX, MXX"):
            prs.read_part("nastran", part, units=AS_WRITTEN, mass="MAA")

    def test_an_option_of_another_kind_of_file(self, part: Path) -> None:
        with pytest.raises(prs.PartFileError, match=r"option 'superelement' says nothing of a \.op4 file"):
            prs.read_part("nastran", part, units=AS_WRITTEN, superelement=101)

    def test_a_component_that_is_not_retained(self, part: Path) -> None:
        """EXTRN and ASET say the same, so that a digit in one of them shows."""
        lines = part.with_suffix(".pch").read_text().replace("EXTRN          3  123456", "EXTRN          3   12346", 1)
        part.with_suffix(".pch").write_text(lines)
        with pytest.raises(prs.PartFileError, match=r"EXTRN and ASET differ at 3\.5"):
            prs.read_part("nastran", part, units=AS_WRITTEN)

    def test_text_that_is_no_op4(self, part: Path) -> None:
        part.write_text("Dear colleague,\nthe matrix is attached.\n")
        with pytest.raises(prs.PartFileError, match="begins with 'Dear colleague,', expected a matrix's columns"):
            prs.read_part("nastran", part, units=AS_WRITTEN)
        with pytest.raises(prs.PartFileError, match="begins with 'Dear colleague,', expected a matrix's columns"):
            nastran.matrices(part)

    def test_units_are_asked_for(self, part: Path) -> None:
        with pytest.raises(prs.PartFileError, match=r"part\.op4: the file does not say its units: add 'units'"):
            prs.read_part("nastran", part)

    def test_a_matrix_cut_short(self, part: Path) -> None:
        part.write_bytes(part.read_bytes()[:9000])
        with pytest.raises(prs.PartFileError, match="truncated"):
            prs.read_part("nastran", part, units=AS_WRITTEN)


@needs_data
def test_in_millimetres_the_numbers_become_si() -> None:
    """The part is 600 mm long; its frequencies stay, its mass is in tonnes."""
    source = DATA / f"{EXPORTS[0]}.op4"
    interfaces = {"near": 3, "turned": 11, "far": [19, 27]}
    element = prs.reduce("nastran", source, nodes=interfaces, units="mm-N-tonne-s")
    assert element.positions[element.node("near")] == pytest.approx([0.6, 0.0, 0.3])
    expected = reference(EXPORTS[0])
    assert element.mass_properties().mass == pytest.approx(1e3 * expected["mass_xyz"][1], rel=1e-8)
    assert element.mass_properties().centre[0] == pytest.approx(1e-3 * expected["cg_from_rb"][0], rel=1e-6)


def test_partial_components_and_words_of_eight_bytes() -> None:
    """pyyeti's own test files, if installed: a point of one component, by EXTSEOUT and by MSC 2017 in 64 bits."""
    import pyyeti

    folder = Path(pyyeti.__file__).parent / "tests" / "nas2cam_extseout"
    if not folder.is_dir():
        pytest.skip("pyyeti is installed without its test files")
    reduced = read(folder / "reduced_bset_notall6.op4", stiffness="KAA", mass="MAA")
    reduced.check()
    assert (reduced.size, reduced.n_modes) == (29, 10)
    assert reduced.labels[18] == "475.uy"
    residual = read(folder / "nas2cam_notall6_msc2017.op2", superelement=0)
    assert residual.labels == reduced.labels
    assert np.allclose(residual.stiffness, reduced.stiffness, rtol=1e-6, atol=1e-9 * np.abs(reduced.stiffness).max())
