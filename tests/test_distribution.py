"""What a user installs: a wheel made from the sdist, alone in an environment, and third-party plug-ins beside it."""

import json
import shutil
import zipfile
from pathlib import Path

import pytest

from tests.distributions import build, install, run

GANTRY = Path(__file__).parent / "description" / "small_machine"


def test_the_wheel_holds_the_packages_and_their_data_only(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        sizes = {entry.filename: entry.file_size for entry in archive.infolist()}
    roots = {name.split("/")[0] for name in sizes}
    assert roots - {"prs_model-0.1.0.dist-info"} == {"prs_model", "prs_reducers", "prs_machines"}
    assert "prs_machines/hexapod/machine.yaml" in sizes
    assert {f"{package}/py.typed" for package in ("prs_model", "prs_reducers", "prs_machines")} <= set(sizes)
    assert not [name for name in sizes if name.endswith(".msh")]
    assert max(sizes.values()) < 2_000_000


def test_the_installed_wheel_finds_its_machines(environment: Path, tmp_path: Path) -> None:
    where = run(environment / "python", "-c", "import prs_model; print(prs_model.__file__)", cwd=tmp_path).stdout
    assert str(environment.parent) in where
    listed = json.loads(run(environment / "prs-model", "machines", "--json", cwd=tmp_path).stdout)["machines"]
    assert {row["name"] for row in listed} == {"head_3prs", "hexapod"}
    assert all(row["problem"] is None and str(environment.parent) in row["folder"] for row in listed)
    for name, first in (("hexapod", 780.6), ("head_3prs", 57.84)):
        setting = ("--set", "reduction.method=craig-bampton")
        done = run(environment / "prs-model", "modes", name, "-n", "1", "--json", *setting, cwd=tmp_path)
        assert done.returncode == 0, done.stderr
        assert json.loads(done.stdout)["frequencies_hz"][0] == pytest.approx(first, rel=0.05)


def test_a_third_party_adds_a_reducer_and_a_machine(environment: Path, tmp_path: Path) -> None:
    project = tmp_path / "gantry_project"
    package = project / "gantry_package"
    shutil.copytree(GANTRY, package)
    (package / "__init__.py").write_text('"""A machine and a reducer from elsewhere."""\n')
    (package / "brick.py").write_text(BRICK)
    text = (package / "machine.yaml").read_text()
    (package / "machine.yaml").write_text(
        text.replace(
            "    reducer: rigid\n    options:\n      mass: 15\n", "    reducer: brick\n    options:\n      mass: 15\n"
        )
    )
    (project / "pyproject.toml").write_text(PROJECT)
    install(environment, build(project, tmp_path / "dist"))

    reducers = json.loads(run(environment / "prs-model", "reducers", "--json", cwd=tmp_path).stdout)["reducers"]
    assert {"name": "brick", "description": "a rigid brick", "problem": None} in reducers
    modes = run(environment / "prs-model", "modes", "gantry", "--json", cwd=tmp_path)
    assert modes.returncode == 0, modes.stderr
    plain = run(environment / "prs-model", "modes", GANTRY, "--json", cwd=tmp_path)
    assert json.loads(modes.stdout)["frequencies_hz"] == pytest.approx(json.loads(plain.stdout)["frequencies_hz"])

    unknown = run(environment / "prs-model", "modes", "gantri", cwd=tmp_path)
    assert unknown.returncode == 1
    assert "known: gantry, head_3prs, hexapod" in unknown.stderr


PROJECT = """
[build-system]
requires = ["hatchling"]
build-backend = "hatchling.build"

[project]
name = "gantry-package"
version = "1.0"
dependencies = ["prs-model"]

[project.entry-points."prs_model.reducers"]
brick = "gantry_package.brick:Brick"

[project.entry-points."prs_model.machines"]
gantry = "gantry_package"
"""

BRICK = """
from prs_model import PartRequest, Reducer, SuperElement
from prs_reducers.rigid import RigidOptions, RigidReducer


class Brick(Reducer):
    description = "a rigid brick"
    Options = RigidOptions
    needs_source = False

    def read(self, part: PartRequest) -> SuperElement:
        return RigidReducer().read(part)
"""
