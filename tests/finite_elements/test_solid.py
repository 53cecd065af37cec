"""The solid reducer against rigid-body physics, closed forms, a NAFEMS benchmark and CalculiX."""

import logging
import shutil
import subprocess
from dataclasses import replace

import meshio
import numpy as np
import pytest
from pydantic import ValidationError
from scipy.sparse.linalg import eigsh

import prs_model as prs
from prs_model.description.units import Units
from prs_model.finite_elements import FiniteElementModel
from prs_model.reduction.coupling import Tie
from prs_model.reduction.craig_bampton import craig_bampton
from prs_reducers.elements.tetrahedra import Material, assemble
from prs_reducers.meshes.mesh_file import read_mesh
from prs_reducers.solid import SolidOptions, solid_model
from tests.meshes import STEEL, box, steel, write

BEAM = (1.0, 0.05, 0.05)


def frequencies(model: FiniteElementModel, count: int) -> np.ndarray:
    """Natural frequencies [Hz] of a held model, solved on its full matrices."""
    values = eigsh(model.stiffness.tocsc(), count, M=model.mass.tocsc(), sigma=0.0, return_eigenvectors=False)
    return np.sqrt(np.sort(values)) / (2.0 * np.pi)


def held(model: FiniteElementModel, fixed: np.ndarray) -> FiniteElementModel:
    """The model without the rows where `fixed` (n,) is true."""
    kept = np.flatnonzero(~fixed)
    return replace(
        model,
        stiffness=model.stiffness[kept][:, kept],
        mass=model.mass[kept][:, kept],
        dofs=model.dofs[kept].copy(),
    )


def bent(points: np.ndarray) -> np.ndarray:
    """A quarter of a bend: x becomes the angle, so that the elements are curved."""
    x, y, z = points.T
    return np.column_stack([(0.3 + y) * np.sin(x / 0.3), (0.3 + y) * np.cos(x / 0.3), z])


def test_rigid_motion_is_free_and_a_box_weighs_what_it_should():
    for mesh in (box((0.4, 0.2, 0.1), (4, 2, 1)), box((0.4, 0.2, 0.1), (4, 2, 1), quadratic=False)):
        model = steel(mesh)
        phi = model.rigid_body_modes()
        assert np.linalg.norm(model.stiffness @ phi) < 1e-12 * abs(model.stiffness).max() * np.linalg.norm(phi)
        properties = model.mass_properties()
        mass = 7850.0 * 0.4 * 0.2 * 0.1
        assert properties.mass == pytest.approx(mass, rel=1e-12)
        assert properties.centre == pytest.approx([0.2, 0.1, 0.05], rel=1e-12)
        inertia = mass / 12.0 * np.array([0.2**2 + 0.1**2, 0.4**2 + 0.1**2, 0.4**2 + 0.2**2])
        assert np.diag(properties.inertia) == pytest.approx(inertia, rel=1e-10 if mesh.elements.shape[1] == 10 else 1)


def test_curved_elements_move_rigidly_too():
    model = steel(box((0.4, 0.1, 0.1), (6, 2, 2), shape=bent))
    phi = model.rigid_body_modes()
    assert np.linalg.norm(model.stiffness @ phi) < 1e-12 * abs(model.stiffness).max() * np.linalg.norm(phi)
    assert model.mass_properties().mass == pytest.approx(7850.0 * 0.4 / 0.3 * 0.1 * 0.1 * 0.35, rel=1e-4)


@pytest.mark.parametrize(("quadratic", "order"), [(True, 4), (False, 2)])
def test_frequencies_converge_at_the_order_of_the_element(quadratic, order):
    """Plate on frictionless walls: the lowest mode is a shear wave, omega = pi sqrt(2) c_s, whatever the thickness."""
    exact = np.sqrt(2.0) / 2.0 * np.sqrt(2.1e11 / 2.6 / 7850.0)
    errors = []
    for n in (8, 16):
        size = np.array([1.0, 1.0, 1.0 / n])
        model = steel(box(tuple(size), (n, n, 1), quadratic=quadratic))
        node, component = model.dofs.T
        at = model.coordinates[node, component]
        slid = held(model, (at < 1e-9) | (at > size[component] - 1e-9))
        errors.append((frequencies(slid, 1)[0] / exact) ** 2 - 1.0)
    assert errors[1] > 0.0
    assert np.log2(errors[0] / errors[1]) == pytest.approx(order, abs=0.25)


def test_cantilever_against_beam_theory():
    """Timoshenko bending 41.69 Hz (twice), torsion 736.5, axial 1293.1, within 0.5 %."""
    model = steel(box(BEAM, (40, 4, 4)))
    root = Tie("root", model.node_sets["x0"], model.set_weights["x0"], np.array([0.0, 0.025, 0.025]), "averaged")
    found = np.sqrt(np.diag(craig_bampton(model, [root], 8).stiffness)[6:]) / (2.0 * np.pi)
    assert found[[0, 1, 6, 7]] == pytest.approx([41.69, 41.69, 736.5, 1293.1], rel=1.2e-3)
    clamped = frequencies(model.clamp(["x0"]), 8)
    assert clamped[[0, 1, 6, 7]] == pytest.approx([41.69, 41.69, 736.5, 1293.1], rel=5e-3)


def test_nafems_fv32_tapered_membrane():
    """NAFEMS FV32 (plane stress, 10 m long, 5 m to 1 m wide, 0.05 m thick, E = 200 GPa, 8000 kg/m3), within 0.2 %.

    Plane stress from solids: half the thickness on a frictionless plane (u_z = 0 at z = 0, the mid-plane), free on the
    other side; at the root u_x = u_y = 0 and u_z is free.
    """

    def taper(points: np.ndarray) -> np.ndarray:
        width = 5.0 - 0.4 * points[:, :1]
        return np.hstack([points[:, :1], (points[:, 1:2] - 0.5) * width, points[:, 2:]])

    model = steel(box((10.0, 1.0, 0.025), (16, 8, 1), shape=taper), E=2.0e11, density=8000.0)
    node, component = model.dofs.T
    root, middle = model.coordinates[node, 0] < 1e-9, model.coordinates[node, 2] < 1e-9
    found = frequencies(held(model, (root & (component < 2)) | (middle & (component == 2))), 6)
    assert found == pytest.approx([44.623, 130.03, 162.70, 246.05, 379.90, 391.44], rel=2e-3)


@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
def test_same_frequencies_as_calculix(tmp_path):
    """*FREQUENCY of ccx on the same curved mesh of C3D10.

    ccx integrates the mass with four points: with the same rule all modes agree to 1e-6. Our mass is exact; the lowest
    modes, which the mesh resolves, then still agree to 1e-4.
    """
    mesh = box((0.4, 0.1, 0.1), (12, 3, 3), shape=bent)
    clamped = np.unique(mesh.groups["x0"]) + 1
    rows = [", ".join(map(str, row)) for row in np.column_stack([np.arange(len(mesh.elements)), mesh.elements]) + 1]
    points = [f"{i}, " + ", ".join(f"{x:.12e}" for x in point) for i, point in enumerate(mesh.points, start=1)]
    deck = ["*NODE, NSET=N", *points, "*ELEMENT, TYPE=C3D10, ELSET=E", *rows]
    deck += ["*MATERIAL, NAME=S", "*ELASTIC", "2.1e11, 0.3", "*DENSITY", "7850.", "*SOLID SECTION, ELSET=E, MATERIAL=S"]
    deck += ["*BOUNDARY", *(f"{node}, 1, 3" for node in clamped)]
    deck += ["*STEP", "*FREQUENCY", "8", "*NODE FILE", "U", "*END STEP"]
    (tmp_path / "bend.inp").write_text("\n".join(deck) + "\n")
    subprocess.run(["ccx", "bend"], cwd=tmp_path, check=True, capture_output=True, timeout=120)
    table = (tmp_path / "bend.dat").read_text().split("(CYCLES/TIME)")[-1].split("P A R T I C")[0]
    theirs = [float(line.split()[3]) for line in table.splitlines() if len(line.split()) == 5]
    model = steel(mesh)
    theirs_too = replace(
        model, mass=assemble(mesh.points, mesh.elements, Material(2.1e11, 0.3, 7850.0), mass_order=2)[1]
    )
    assert frequencies(theirs_too.clamp(["x0"]), 8) == pytest.approx(theirs[:8], rel=1e-6)
    assert frequencies(model.clamp(["x0"]), 6) == pytest.approx(theirs[:6], rel=1e-4)


def test_a_mesh_file_in_millimetres_is_the_same_part(tmp_path):
    mesh = box((0.2, 0.1, 0.1), (2, 1, 1))
    path = write(mesh, tmp_path / "block.msh", scale=1000.0)
    options = SolidOptions.model_validate({"material": STEEL})
    model, direct = solid_model(read_mesh(path), options, 1e-3), steel(mesh)
    assert abs(model.stiffness - direct.stiffness).max() < 1e-9 * abs(direct.stiffness).max()
    assert set(model.node_sets) == {"x0", "x1", "y0", "y1", "z0", "z1", "all"}
    assert model.set_weights["x1"].sum() == pytest.approx(0.01)
    assert model.coordinates[model.node_sets["x1"]] == pytest.approx(direct.coordinates[direct.node_sets["x1"]])
    assert model.areas.sum() == pytest.approx(2 * (0.02 + 0.02 + 0.01))


def test_materials_by_volume():
    mesh = box((0.2, 0.1, 0.1), (2, 1, 1))
    left = mesh.points[mesh.elements[:, :4], 0].mean(axis=1) < 0.1
    mesh = replace(mesh, volumes={"left": np.flatnonzero(left), "right": np.flatnonzero(~left)})
    heavy = STEEL | {"density": 15700.0}
    model = solid_model(mesh, SolidOptions.model_validate({"materials": {"left": STEEL, "right": heavy}}))
    assert model.mass_properties().mass == pytest.approx(0.001 * (7850.0 + 15700.0))
    for materials, words in (
        ({"left": STEEL, "rihgt": heavy}, "did you mean 'right'"),
        ({"left": STEEL}, "6 elements have no material"),
    ):
        with pytest.raises(prs.PartFileError, match=words):
            solid_model(mesh, SolidOptions.model_validate({"materials": materials}))


def test_forgotten_units_are_noticed(tmp_path, caplog):
    path = write(box((0.2, 0.1, 0.1), (2, 1, 1)), tmp_path / "block.msh")
    ends = {"interfaces": {"end": {"set": "x0"}}, "modes": 0}
    tonnes = {"units": Units(length="mm", mass="kg")}
    with pytest.raises(ValidationError, match=r"density = 7.85e-09 kg/mm\^3 \(7.85 kg/m\^3\).* 7.85e-06 kg/mm\^3"):
        SolidOptions.model_validate({"material": {"E": 2.1e5, "nu": 0.3, "density": 7.85e-9}}, context=tonnes)
    with pytest.raises(prs.DescriptionError, match=r"found E = 2.1e\+05 N/m\^2, which no solid has"):
        prs.reduce("solid", path, units="m-N-kg-s", material=STEEL | {"E": 2.1e5}, **ends)
    with pytest.raises(prs.DescriptionError, match="found neither, expected 'material' or 'materials'"):
        prs.reduce("solid", path, units="m-N-kg-s", **ends)
    with caplog.at_level(logging.WARNING, logger="prs_model"):
        prs.reduce("solid", path, units="mm-N-tonne-s", material=STEEL, **ends)
    assert "its nodes are 0.0002 m apart; check 'units'" in caplog.text


def test_four_node_tetrahedra_are_taken_with_a_note(caplog):
    with caplog.at_level(logging.WARNING, logger="prs_model"):
        steel(box((0.2, 0.1, 0.1), (2, 1, 1), quadratic=False))
    assert "too stiff in bending" in caplog.text


def test_what_is_no_mesh_of_tetrahedra_is_refused(tmp_path):
    garbage = tmp_path / "part.msh"
    garbage.write_text("this is no mesh\n")
    bricks = tmp_path / "bricks.msh"
    corners = np.array([[x, y, z] for z in (0, 1) for x, y in ((0, 0), (1, 0), (1, 1), (0, 1))], dtype=float)
    meshio.write_points_cells(bricks, corners, [("hexahedron", np.arange(8)[None])], file_format="gmsh22", binary=False)
    inverted = box((0.2, 0.1, 0.1), (2, 1, 1))
    inverted.elements[3, [0, 1]] = inverted.elements[3, [1, 0]]
    doubled = box((0.2, 0.1, 0.1), (2, 1, 1))
    doubled = replace(doubled, elements=np.vstack([doubled.elements, doubled.elements[:1]]))
    doubled = replace(doubled, groups=doubled.groups | {"all": doubled.elements})
    material = {"material": STEEL, "interfaces": {"end": {"set": "x0"}}}
    for path, units, words in (
        (garbage, "m-N-kg-s", "cannot read it as a mesh"),
        (bricks, "m-N-kg-s", "found cells hexahedron"),
        (tmp_path / "none.msh", "m-N-kg-s", "no such file"),
        (write(inverted, tmp_path / "inverted.msh"), "m-N-kg-s", "turned inside out"),
        (write(doubled, tmp_path / "doubled.msh"), "m-N-kg-s", "faces belong to more than two elements"),
        (write(box(BEAM, (2, 1, 1)), tmp_path / "beam.msh"), None, "the file does not say its units: add 'units'"),
        (tmp_path / "beam.msh", "mm-N-kg-s", "not consistent"),
    ):
        with pytest.raises(prs.PartFileError, match=words):
            prs.reduce("solid", path, units=units, **material)
