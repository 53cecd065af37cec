"""Rebuilding parts of the head: nothing shipped is lost when it fails."""

import shutil
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_machines.head_3prs import rebuild
from prs_model.description import load_description
from prs_model.finite_elements import MassProperties
from prs_model.plugins import machine_folder
from prs_model.reduction import SuperElement


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A copy of the machine without meshes."""
    shipped = machine_folder("head_3prs")
    shutil.copytree(shipped / "reduced", tmp_path / "reduced")
    for name in ("machine.yaml", "head_3prs.urdf"):
        shutil.copy(shipped / name, tmp_path)
    return tmp_path


def stored(folder: Path) -> list[str]:
    return sorted(path.name for path in (folder / "reduced").iterdir())


def test_a_part_that_cannot_be_made_keeps_what_is_stored(folder: Path) -> None:
    before = stored(folder)
    with pytest.raises(prs.PartFileError, match="there is no such file"):
        rebuild._reduce("rod", "rod_1", load_description(folder))
    assert stored(folder) == before


def test_a_new_part_takes_the_place_of_the_old_ones(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    old = sorted((folder / "reduced").glob("rod-*.npz"))

    def build(name, body, reduction, place, *, stem):  # type: ignore[no-untyped-def]
        SuperElement.load(old[0]).save(place / reduction.store / f"{stem}-new-{reduction.method}.npz")

    monkeypatch.setattr(rebuild, "build_part", build)
    others = [name for name in stored(folder) if not name.startswith("rod-")]
    rebuild._reduce("rod", "rod_1", load_description(folder))
    assert stored(folder) == sorted([*others, "rod-new-craig-bampton.npz", "rod-new-joint-loaded.npz"])


def test_inertia_is_written_and_nothing_else(folder: Path) -> None:
    urdf = folder / "head_3prs.urdf"
    before = urdf.read_text(encoding="utf-8")
    inertial = load_description(folder).urdf.links["rod_1"].inertial
    assert inertial is not None
    same = MassProperties(inertial.mass, np.array(inertial.xyz), np.array(inertial.inertia))
    rebuild.write_inertia(urdf, ["rod_1"], same)
    assert urdf.read_text(encoding="utf-8") == before
    with pytest.raises(prs.PrsError, match="link nobody has no <inertial>"):
        rebuild.write_inertia(urdf, ["nobody"], same)
