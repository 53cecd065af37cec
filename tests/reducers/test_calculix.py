"""The calculix reducer: CalculiX's own frequencies, of stored exports and of a run made here, and what it refuses."""

from __future__ import annotations

import gzip
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.finite_elements import FiniteElementModel
from prs_model.reduction.summary import summarize
from tests.superelements import DATA, needs_data, reference

UNITS = "mm-N-tonne-s"
MATERIAL = "*MATERIAL,NAME=STEEL\n*ELASTIC\n210000,0.3\n*DENSITY\n7.85E-9\n*SOLID SECTION,ELSET=EALL,MATERIAL=STEEL\n"
SIZE = (160.0, 30.0, 20.0)  # mm; no two bending frequencies alike


def read(source: Path, **options: object) -> FiniteElementModel:
    model = prs.read_part("calculix", source, units=UNITS, **options)
    assert isinstance(model, FiniteElementModel)
    return model


@needs_data
def test_the_free_bracket_is_as_recorded():
    record = reference("calculix/full_free")
    model = read(DATA / "calculix" / "full_free.sti.gz")
    properties = model.mass_properties()
    assert model.size == record["size"][0]
    assert properties.mass * 1e-3 == pytest.approx(record["mass_t"][0], rel=1e-13)
    np.testing.assert_allclose(properties.centre * 1e3, record["cg_mm"], rtol=1e-13)
    phi = model.rigid_body_modes()
    about_origin = np.diag(phi.T @ (model.mass @ phi))[3:] * 1e3  # t mm^2 from kg m^2
    np.testing.assert_allclose(about_origin, record["inertia_origin_t_mm2"], rtol=1e-12)
    np.testing.assert_allclose(model.frequencies(16)[6:], record["freq_hz_first16"][6:], rtol=1e-9)
    assert np.all(np.abs(model.frequencies(6)) < 0.1)


@needs_data
def test_the_held_bracket_is_as_recorded():
    record = reference("calculix/full_fixed")
    model = read(DATA / "calculix" / "full_fixed.sti.gz")
    np.testing.assert_allclose(model.frequencies(16), record["freq_hz_first16"], rtol=1e-9)
    assert model.mass_properties().mass * 1e-3 == pytest.approx(record["mass_t"][0], rel=1e-13)
    assert sorted(model.node_sets) == ["EALL", "NALL", "NIF1", "NIF2"]


@needs_data
def test_the_bracket_is_the_one_that_the_solver_solved():
    """Against CalculiX's own tables of frequencies, of seven digits, and the CAD body that was meshed."""
    record = reference("calculix/solver_frequencies_hz")
    free, fixed = (read(DATA / "calculix" / f"full_{name}.sti.gz") for name in ("free", "fixed"))
    np.testing.assert_allclose(free.frequencies(12)[6:], record["freq_free.dat_elastic"], rtol=1e-6)
    np.testing.assert_allclose(fixed.frequencies(10), record["freq_fixed.dat"], rtol=1e-6)
    properties = free.mass_properties()  # elements with straight edges in the bores have a little more volume
    assert properties.mass * 1e-3 == pytest.approx(record["CAD_mass_t"], rel=1e-4)
    np.testing.assert_allclose(properties.centre * 1e3, record["CAD_cg_mm"], atol=1e-3)


@needs_data
def test_a_gmsh_mesh_serves_as_well_as_the_deck():
    source = DATA / "calculix" / "full_free.sti.gz"
    model = read(source, mesh="bracket.msh")
    assert {name: len(nodes) for name, nodes in model.node_sets.items()} == {"IF1": 70, "IF2": 70, "BODY": 1752}
    bores = [prs.reduce("calculix", source, interfaces=sets, units=UNITS, **more) for sets, more in (
        ({"bore": {"set": "NIF1"}}, {}), ({"bore": {"set": "IF1"}}, {"mesh": "bracket.msh"}))]  # fmt: skip
    np.testing.assert_allclose(bores[0].stiffness, bores[1].stiffness, atol=1e-9 * np.abs(bores[0].stiffness).max())


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A bar meshed by gmsh, its full matrices and its frequencies by CalculiX, free and held at one end."""
    if shutil.which("ccx") is None:
        pytest.skip("CalculiX (ccx) is not installed")
    pytest.importorskip("gmsh", reason="gmsh meshes the bar", exc_type=(ImportError, OSError))
    folder = tmp_path_factory.mktemp("ccx")
    (folder / "bar.inc").write_text(_mesh(folder / "bar.msh"))
    held = "*BOUNDARY\nNX0,1,3\n"
    for name, boundary in (("free", ""), ("held", held)):
        _run(folder, name, f"{boundary}*STEP\n*FREQUENCY,SOLVER=MATRIXSTORAGE\n*END STEP\n")
        _run(folder, f"{name}_modes", f"{boundary}*STEP\n*FREQUENCY\n14\n*END STEP\n")
    retained = "*RETAINED NODAL DOFS\nNX0,1,3\nNX1,1,3\n"
    output = "*SUBSTRUCTURE MATRIX OUTPUT,STIFFNESS=YES,OUTPUT FILE=USER DEFINED,FILE NAME=reduced\n"
    _run(folder, "substructure", f"*STEP\n*SUBSTRUCTURE GENERATE\n{retained}{output}*END STEP\n")
    return folder


def _mesh(msh: Path) -> str:
    from prs_machines.head_3prs.gmsh_solids import box, model

    with model("bar", 14.0) as gmsh:
        _, solid = box(gmsh, *((0.0, length) for length in SIZE))
        gmsh.model.occ.synchronize()
        gmsh.model.addPhysicalGroup(3, [solid], name="BAR")
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        gmsh.write(str(msh))
        tags, places, _ = gmsh.model.mesh.getNodes()
        _, (labels,), (nodes,) = gmsh.model.mesh.getElements(3)
    points = places.reshape(-1, 3)
    order = [0, 1, 2, 3, 4, 5, 6, 7, 9, 8]  # gmsh's last two mid-side nodes are the other way round
    lines = ["*NODE"] + [f"{tag}, {x:.16g}, {y:.16g}, {z:.16g}" for tag, (x, y, z) in zip(tags, points, strict=True)]
    lines += ["*ELEMENT,TYPE=C3D10,ELSET=EALL"]
    lines += [
        ", ".join(map(str, [label, *row[order]])) for label, row in zip(labels, nodes.reshape(-1, 10), strict=True)
    ]
    for name, x in (("NX0", 0.0), ("NX1", SIZE[0])):
        lines += [f"*NSET,NSET={name}", *(f"{tag}," for tag in tags[np.abs(points[:, 0] - x) < 1e-9])]
    return "\n".join(lines) + "\n" + MATERIAL


def _run(folder: Path, name: str, step: str) -> None:
    (folder / f"{name}.inp").write_text("*INCLUDE,INPUT=bar.inc\n" + step)
    subprocess.run(["ccx", name], cwd=folder, capture_output=True, check=False, timeout=120)


def solved(dat: Path) -> np.ndarray:
    """ccx's table of eigenvalues, as frequencies [Hz] of seven digits."""
    rows = re.findall(r"^ +\d+ +\S+ +\S+ +(\S+) +\S+$", dat.read_text().split("P A R T I C")[0], re.MULTILINE)
    return np.array(rows, dtype=float)


def test_frequencies_equal_those_of_ccx(run):
    held = solved(run / "held_modes.dat")
    np.testing.assert_allclose(read(run / "held.sti").frequencies(len(held)), held, rtol=1e-6)
    free = solved(run / "free_modes.dat")[6:]
    np.testing.assert_allclose(read(run / "free.sti").frequencies(14)[6:], free, rtol=1e-6)
    np.testing.assert_allclose(read(run / "free.sti", mesh="bar.msh").frequencies(14)[6:], free, rtol=1e-6)


@pytest.mark.parametrize("coupling", ["rigid", "averaged"])
def test_reduced_frequencies_bound_those_of_ccx_from_above(run, coupling):
    """Ritz: a subspace, or a rigid tie, makes no frequency lower; with more modes they come down towards ccx's."""
    free, held = solved(run / "free_modes.dat")[6:], solved(run / "held_modes.dat")
    ends = {"root": {"set": "NX0"}, "tip": {"set": "NX1"}}
    found = []
    for modes in (2, 12):
        element = prs.reduce("calculix", run / "free.sti", units=UNITS, interfaces=ends, modes=modes, coupling=coupling)
        found.append(summarize(element, 4).free)
        assert np.all(found[-1] >= free[:4] * (1 - 1e-6))
    assert np.all(found[1] <= found[0] * (1 + 1e-9))
    tip = {"tip": ends["tip"]}
    options = {"units": UNITS, "interfaces": tip, "modes": 12, "coupling": coupling, "grounded": True}
    by_ccx = prs.reduce("calculix", run / "held.sti", **options)
    by_us = prs.reduce("calculix", run / "free.sti", clamped=("NX0",), **options)
    np.testing.assert_allclose(summarize(by_ccx, 4).free, summarize(by_us, 4).free, rtol=1e-8)
    assert np.all(summarize(by_ccx, 4).free >= held[:4] * (1 - 1e-6))
    if coupling == "averaged":
        np.testing.assert_allclose(found[1], free[:4], rtol=1e-2)


def test_a_held_part_must_be_said_to_be_grounded(run):
    with pytest.raises(prs.PhysicsError, match="grounded: true"):
        prs.reduce("calculix", run / "held.sti", units=UNITS, interfaces={"tip": {"set": "NX1"}})


@pytest.mark.parametrize("reducer", ["calculix", "abaqus"])
def test_the_uncondensed_substructure_of_ccx_is_refused(run, reducer):
    with pytest.raises(prs.PartFileError, match=r"not the condensed one.*MATRIXSTORAGE"):
        prs.read_part(reducer, run / "reduced.mtx", units=UNITS, mesh="bar.inc")


def bracket(folder: Path, name: str, change: dict[str, object] | None = None) -> Path:
    """A copy of the stored bracket, unpacked, with files changed by functions of their lines."""
    for file in [*(DATA / "calculix").glob(f"{name}.*"), DATA / "calculix" / "bracket_mesh.inc"]:
        data = gzip.decompress(file.read_bytes()) if file.suffix == ".gz" else file.read_bytes()
        plain = file.name.removesuffix(".gz")
        lines = data.decode().splitlines(keepends=True)
        changed = (change or {}).get(plain.rpartition(".")[2], lambda lines: lines)
        (folder / plain).write_text("".join(changed(lines)))  # type: ignore[operator]
    return folder / f"{name}.sti"


def test_other_files_are_not_the_source(tmp_path):
    (tmp_path / "part.sti").touch()
    for name, found in (("part.inp", ".inp is not read"), ("part.mtx", ".mtx is not read"), ("port", "no such file")):
        if name != "port":
            (tmp_path / name).write_text("1 1 2.0\n")
        with pytest.raises(prs.PartFileError, match=f"{found}, expected .sti or .sti.gz.*beside it is part.sti"):
            read(tmp_path / name)


def swap(a: int, b: int):
    def swapped(lines: list[str]) -> list[str]:
        lines = list(lines)
        lines[a], lines[b] = lines[b], lines[a]
        return lines

    return swapped


def with_entry(line: int, value: float):
    def changed(lines: list[str]) -> list[str]:
        row, column, old = lines[line].split()
        assert float(old) != value
        return [*lines[:line], f"{row} {column} {value:.13e}\n", *lines[line + 1 :]]

    return changed


BAD = {
    "rows of .dof in another order": ({"dof": swap(3000, 4000)}, "act on each other, but share no element"),
    "neighbouring rows of .dof": ({"dof": swap(3000, 3001)}, "differs along x and"),
    "a row too few": ({"dof": lambda lines: lines[:-1]}, r"its last entry is 5046 5046, expected 5045 5045"),
    "a motion that is none": ({"dof": lambda lines: [*lines[:-1], "7.4\n"]}, "row 5046 is '7.4', expected node.1 to"),
    "a node of no mesh": (
        {"dof": lambda lines: [*lines[:-1], "9999.3\n"]},
        r"not in full_fixed.inp \(the first is 9999",
    ),
    "a row twice": ({"dof": lambda lines: [*lines[:-1], lines[0]]}, "1 motions have more than one row"),
    "truncated": (
        {"sti": lambda lines: lines[:-5]},
        r"\.sti: its last entry is .*, expected 5046 5046.*full_fixed.dof has rows.*of another job",
    ),
    "a line lost": ({"sti": lambda lines: lines[:70] + lines[71:]}, r"\.mas: its entries are not at the places"),
    "lines swapped": ({"mas": swap(900, 901)}, r"\.mas: not an upper triangle column by column"),
    "a stiffness changed": ({"sti": with_entry(80_000, 1.0)}, "resist rigid motion though no held node is near"),
    "a mass changed": ({"mas": with_entry(80_000, 1e-9)}, "differs along x and"),
    "no number": ({"mas": lambda lines: ["1 1 x\n", *lines[1:]]}, r"\.mas: line 1: found 'x', expected a number"),
    "mass for stiffness": ({"sti": lambda _: mass_lines()}, "resist rigid motion|no stiffness|act on each other"),
    "deck of the free part": ({"inp": lambda lines: [lines[0]]}, r"no \*BOUNDARY of full_fixed.inp holds them in"),
}


def mass_lines() -> list[str]:
    return gzip.decompress((DATA / "calculix" / "full_fixed.mas.gz").read_bytes()).decode().splitlines(keepends=True)


@needs_data
@pytest.mark.parametrize("what", BAD)
def test_a_damaged_held_part_is_refused(tmp_path, what):
    """A held part costs energy in rigid motion anyway, so the gate alone would not see these."""
    change, message = BAD[what]
    with pytest.raises(prs.PartFileError, match=message):
        read(bracket(tmp_path, "full_fixed", change))


@needs_data
def test_plain_packed_and_bare_names_are_the_same_part(tmp_path):
    plain = bracket(tmp_path, "full_free")
    packed = read(DATA / "calculix" / "full_free.sti.gz")
    for source in (plain, plain.with_suffix("")):
        assert abs(read(source).stiffness - packed.stiffness).max() == 0.0
        element = prs.reduce("calculix", source, units=UNITS, interfaces={"bore": {"set": "NIF1"}}, modes=1)
        assert element.nodes == ("bore",)
