"""The shipped super-elements of the head: physics, agreement with the URDF and the folder, size."""

from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_machines.head_3prs.rebuild import PAPER
from prs_model.description import MachineDescription, load_description
from prs_model.plugins import machine_folder
from prs_model.reduction import SuperElement, TravellingElement, build_part

PARTS = ("base", "board", "slider", "rod", "platform")
FREE_PARTS = PARTS[1:]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The machine's folder as it is shipped: without meshes."""
    shipped, copy = machine_folder("head_3prs"), tmp_path_factory.mktemp("head")
    for name in ("machine.yaml", "head_3prs.urdf", "reduced"):
        (copy / name).symlink_to(shipped / name)
    return copy


@pytest.fixture(scope="module")
def description(folder: Path) -> MachineDescription:
    return load_description(folder)


def elements(description: MachineDescription, stem: str) -> list[SuperElement]:
    """The stored elements of a part, as the machine reduces it and as the paper does; one per station if it travels."""
    name = next(name for name in description.bodies if description.stems[name] == stem)
    found: list[SuperElement] = []
    for reduction in (description.file.reduction, PAPER):
        settings = reduction.model_copy(update={"store": description.file.reduction.store})
        part = build_part(name, description.bodies[name], settings, description.folder, stem=stem)
        found += part.elements if isinstance(part, TravellingElement) else (part,)
    return found


@pytest.mark.parametrize("stem", PARTS)
def test_gate(description: MachineDescription, stem: str) -> None:
    for element in elements(description, stem):
        element.check()


@pytest.mark.parametrize("stem", FREE_PARTS)
def test_mass_and_inertia_are_those_of_the_urdf(description: MachineDescription, stem: str) -> None:
    frame = next(body.frame for name, body in description.bodies.items() if description.stems[name] == stem)
    inertial = description.urdf.links[frame].inertial
    assert inertial is not None
    for element in elements(description, stem):
        found = element.mass_properties()
        assert found.mass == pytest.approx(inertial.mass, rel=1e-6)
        np.testing.assert_allclose(found.centre, inertial.xyz, atol=1e-7)
        np.testing.assert_allclose(found.inertia, inertial.inertia, rtol=1e-5, atol=1e-6)


def test_identical_limbs_have_equal_inertia(description: MachineDescription) -> None:
    for stem in ("board", "slider", "rod"):
        masses = [description.urdf.links[f"{stem}_{i}"].inertial.mass for i in (1, 2, 3)]  # type: ignore[union-attr]
        assert len(set(masses)) == 1


def test_two_small_files_per_part(folder: Path) -> None:
    """As the machine reduces it and as the paper does."""
    files = sorted((folder / "reduced").glob("*.npz"))
    assert [path.name.split("-")[0] for path in files] == sorted([*PARTS, *PARTS])
    assert all(path.stat().st_size < 2e6 for path in files)


def test_parts_touch_where_joints_join_them(description: MachineDescription) -> None:
    """Both ends of every joint stand at the same point of the reference configuration."""
    machine = prs.Machine(description).replace({"reduction.method": "craig-bampton"})  # one node per joint
    configuration = machine.configuration()
    for joint in description.joints.values():
        ends = []
        for body, interface in (end.split(".") for end in joint.between):
            element = machine.parts[body]
            if isinstance(element, TravellingElement):
                element = element.at(configuration.joint_values[element.joint])
            position = element.positions[element.node(interface)]
            ends.append(configuration.placement(description.bodies[body].frame).act(position))
        np.testing.assert_allclose(ends[0], ends[1], atol=1e-6)
