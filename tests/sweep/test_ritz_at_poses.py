"""Frequencies at any poses from one basis: within their bounds of the dense ones, above them, and none missing."""

from __future__ import annotations

import ast
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import prs_model as prs
from prs_model.linear_algebra import positive_definite_pencil
from prs_model.reduction import SuperElement
from prs_model.sweep.enclosed import kernels_ritz
from prs_model.sweep.enclosed.basis_at_poses import leading_shapes, ritz_at_poses
from prs_model.sweep.enclosed.dual_packed import packed
from prs_model.sweep.enclosed.ritz_at_poses import RitzAtPoses
from prs_model.sweep.exact import Solver, part
from prs_model.sweep.low_modes import low_modes
from prs_model.sweep.not_smooth import NotSmoothError
from prs_model.sweep.poses import Poses
from prs_model.sweep.request import Request
from prs_model.synthesis import assemble_many
from prs_model.synthesis.dual import DualSystems, dual_assembly
from tests.sweep.nasty import nasty
from tests.sweep.stick import stick
from tests.verification.gantry import TRAVEL, gantry

COUNT = 6
ROUNDING = 1e-9
"""Of the dense solver's frequencies of machines with very stiff joints."""
HINGE = {"joints.R.stiffness": {"ux": "rigid", "uy": 9.0e8, "uz": "rigid", "rx": 9.0e5, "ry": 9.0e5}}
NO_GAP = tuple(40.0 * 1.01**k for k in range(16))
CROSSING = (30.0, 40.0, 41.0, 55.0, 70.0, 300.0)
PAIR = (35.0, 35.0, 50.0, 50.0, 50.0, 300.0)
LOW = (12.0, 13.0, 14.0, 15.0, 18.0, 22.5)
KINDS = ["head", "hexapod", "travelling contact", "no gap", "crossing", "a repeated pair", "one pose"]


@dataclass(frozen=True, eq=False)
class Case:
    """A basis for a list of poses, and the first of these."""

    machine: prs.Machine
    some: np.ndarray
    found: RitzAtPoses


def machine_of(kind: str, folder: Path) -> prs.Machine:
    if kind in ("head", "hexapod"):
        return prs.load_machine({"head": "head_3prs"}.get(kind, kind))
    if kind == "travelling contact":
        return gantry(folder, travel=TRAVEL).replace(HINGE)
    if kind == "one pose":
        return stick(folder, held=True)
    rows = {"no gap": NO_GAP, "crossing": CROSSING, "a repeated pair": PAIR}
    return nasty(folder, rows.get(kind, LOW), 4000.0 if kind in rows else 4e4)


def listed(machine: prs.Machine, count: int = 400) -> Poses:
    """Poses all over the workspace."""
    low, high = np.array([machine.workspace[name] for name in machine.pose_names]).reshape(-1, 2).T
    return Poses(machine.pose_names, (), low + (high - low) * np.random.default_rng(21).random((count, len(low))))


def basis(machine: prs.Machine, poses: Poses, kernels: ModuleType = kernels_ritz) -> RitzAtPoses:
    home = machine.assemble(machine.configuration())
    shift, _ = positive_definite_pencil(home.mass, home.stiffness)
    with ThreadPoolExecutor(2) as pool:
        return ritz_at_poses(Request(n_modes=COUNT), Solver(machine, COUNT, shift), poses, pool, kernels)[0]


def dual_at(machine: prs.Machine, poses: np.ndarray) -> DualSystems:
    found = machine.kinematics.solve_batch(poses)
    found = part(found, np.flatnonzero(found.reachable))
    return dual_assembly(machine.description, machine.parts, machine.joints, found)


def exact_at(machine: prs.Machine, poses: np.ndarray, count: int = COUNT) -> np.ndarray:
    """(N, count) [Hz] of the poses within reach."""
    found = machine.kinematics.solve_batch(poses)
    each = [machine.assemble(found[int(i)]).modes(count).frequencies for i in np.flatnonzero(found.reachable)]
    return np.array(each)


@pytest.fixture(scope="module")
def compiled() -> ModuleType:
    pytest.importorskip("numba", reason="compiled kernels come with the extra `fast`")
    from prs_model.sweep.enclosed import kernels_ritz_jit

    return kernels_ritz_jit


@pytest.fixture(scope="module", params=KINDS)
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory, compiled: ModuleType) -> Case:
    machine = machine_of(str(request.param), tmp_path_factory.mktemp("machine"))
    poses = listed(machine, 400 if machine.pose_names else 1)
    return Case(machine, poses.block(0, 16), basis(machine, poses, compiled))


def test_frequencies_are_within_their_bounds_and_upper_bounds(case: Case, compiled: ModuleType) -> None:
    frequencies, bounds, complete = case.found.frequencies(dual_at(case.machine, case.some), COUNT, compiled)
    errors = frequencies / exact_at(case.machine, case.some) - 1.0
    assert complete.mean() > 0.9
    assert (bounds.max(axis=1) <= 1e-6).mean() > 0.9
    assert (np.abs(errors) <= bounds).all()
    assert (errors >= -ROUNDING).all()


def test_compiled_and_plain_kernels_agree(case: Case, compiled: ModuleType) -> None:
    dual = dual_at(case.machine, case.some)
    ours, theirs = (case.found.frequencies(dual, COUNT, each) for each in (compiled, kernels_ritz))
    np.testing.assert_allclose(ours[0], theirs[0], rtol=1e-9)
    np.testing.assert_allclose(ours[1], theirs[1], rtol=1e-2, atol=ROUNDING)
    np.testing.assert_array_equal(ours[2], theirs[2])


@pytest.mark.parametrize("kind", ["head", "hexapod", "travelling contact"])
def test_eigenvalues_below_any_level_are_counted(kind: str, tmp_path: Path, compiled: ModuleType) -> None:
    machine = machine_of(kind, tmp_path)
    poses = listed(machine, 12).points
    assert poses is not None
    exact, dual = exact_at(machine, poses, 60), dual_at(machine, poses)
    none = np.zeros((sum(each.size for each in dual.elements.values()), 0))
    for frequency in np.linspace(0.8 * exact.min(), 1.05 * exact[:, 5].max(), 7):
        level = (2.0 * np.pi * frequency) ** 2
        S, less = dual.at(level)
        expected = (exact < frequency).sum(axis=1)
        np.testing.assert_array_equal(less - (np.linalg.eigvalsh(S) < 0.0).sum(axis=1), expected)
        for kernels in (kernels_ritz, compiled):
            number, sure = kernels.below(packed(dual, none, -0.1 * level, level))
            np.testing.assert_array_equal(number[sure], expected[sure])
            assert sure.mean() > 0.9


def test_a_shape_that_the_basis_lacks_is_noticed(tmp_path: Path) -> None:
    """The masses of the row do not feel anything else: no application of T brings back one that is missing."""
    machine = machine_of("crossing", tmp_path)
    poses = listed(machine)
    found, some = basis(machine, poses), poses.block(0, 5)
    home = Solver(machine, COUNT, 0.0).solve(machine.kinematics.solve_batch(some[:1]))
    mass = home.systems.mass[0]
    mode = home.modes.shapes[0][:, np.argmin(np.abs(home.modes.eigenvalues[0] - (2.0 * np.pi * CROSSING[0]) ** 2))]
    rest = found.shapes - np.outer(mode, mode @ mass @ found.shapes)
    lacking = replace(found, shapes=leading_shapes(mass, rest, found.size - 1))
    assert found.frequencies(dual_at(machine, some), COUNT)[2].all()
    _, bounds, complete = lacking.frequencies(dual_at(machine, some), COUNT)
    assert not complete.any()
    assert np.isinf(bounds).all()


def test_a_mode_that_no_snapshot_shows_is_noticed_where_it_comes_down(tmp_path: Path) -> None:
    machine = machine_of("beside", tmp_path)
    phi = np.pi / 2.0 + np.linspace(-0.9, 0.5, 421)
    points = np.column_stack([np.full_like(phi, 0.5), np.full_like(phi, 0.5), phi])
    found = basis(machine, Poses(machine.pose_names, (), points[np.abs(phi - np.pi / 2.0) > 0.1]))
    near = points[np.abs(phi - np.pi / 2.0) < 0.05]
    frequencies, bounds, complete = found.frequencies(dual_at(machine, near), COUNT)
    exact = exact_at(machine, near)
    below = 4e4 * np.abs(np.cos(near[:, 2])) < np.sqrt(found.level) / (2.0 * np.pi)
    assert 0 < below.sum() < len(near)
    np.testing.assert_array_equal(complete, ~below)
    assert np.isinf(bounds[below]).all()
    assert (np.abs(frequencies / exact - 1.0) <= bounds).all()


def test_coordinates_without_mass_or_stiffness_are_held_by_joints_alone(tmp_path: Path, compiled: ModuleType) -> None:
    """The lower block without its mass is nothing but a place between two joints."""
    machine = stick(tmp_path, held=True)
    block = machine.parts["block"]
    assert isinstance(block, SuperElement)
    nothing = np.zeros_like(block.mass)
    parts = {**machine.parts, "block": replace(block, mass=nothing)}
    configurations = machine.kinematics.solve_batch(np.zeros((1, 0)))
    systems = assemble_many(machine.description, parts, machine.joints, configurations)
    modes = low_modes(systems, COUNT + 2, 0.0)
    level = float(np.sqrt(modes.eigenvalues[0, COUNT - 1] * modes.eigenvalues[0, COUNT]))
    shapes = leading_shapes(systems.mass[0], modes.shapes[0][:, :COUNT], COUNT)
    found = RitzAtPoses(shapes, -0.1 * level, level, 0.0, np.full(COUNT, 1e-10))
    dual = dual_assembly(machine.description, parts, machine.joints, configurations)
    assert dual.size == len(dual.joints) + len(nothing)
    for kernels in (kernels_ritz, compiled):
        frequencies, bounds, complete = found.frequencies(dual, COUNT, kernels)
        assert complete.all()
        errors = 2.0 * np.pi * frequencies / np.sqrt(modes.eigenvalues[:, :COUNT]) - 1.0
        assert (np.abs(errors) <= bounds).all()


def test_a_machine_that_moves_freely_has_no_relative_bounds(tmp_path: Path) -> None:
    machine = stick(tmp_path, held=False)
    with pytest.raises(NotSmoothError):
        basis(machine, listed(machine, 1))


@pytest.mark.parametrize("name", ["kernels_ritz", "kernels_ritz_jit", "small_jit"])
def test_kernels_import_numpy_and_numba_only(name: str) -> None:
    tree = ast.parse((Path(kernels_ritz.__file__).parent / f"{name}.py").read_text())
    imports = {
        alias.name if isinstance(node, ast.Import) else "." * node.level + str(node.module)
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for alias in node.names
    }
    assert imports <= {"__future__", "numba", "numpy", "numpy.typing", "typing", ".small_jit"}
