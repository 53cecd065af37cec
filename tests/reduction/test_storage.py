"""Stored super-elements: exact round trip, and clear words for files that are damaged or something else."""

import io
import json
import pickle
import zipfile
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model.description.schema import Interface
from prs_model.reduction import storage
from prs_model.reduction.from_model import reduce_model
from prs_model.reduction.recipe import Settings
from prs_model.reduction.stations import reduce_travelling
from tests.meshes import box, steel

SETTINGS = Settings("rigid", "joint", 2)


@pytest.fixture(scope="module")
def element() -> prs.SuperElement:
    model = steel(box((0.4, 0.1, 0.08), (5, 2, 1)))
    return reduce_model(model, {"a": Interface(set="x0"), "b": Interface(set="x1")}, SETTINGS)


@pytest.fixture
def path(element: prs.SuperElement, tmp_path: Path) -> Path:
    element.save(tmp_path / "part.npz")
    return tmp_path / "part.npz"


def assert_same(one: prs.SuperElement, other: prs.SuperElement) -> None:
    for name in ("stiffness", "mass", "positions", "motions"):
        assert np.array_equal(getattr(one, name), getattr(other, name))
        assert not getattr(other, name).flags.writeable
    for name in ("nodes", "labels", "n_modes", "grounded", "provenance"):
        assert getattr(one, name) == getattr(other, name)
    for name in ("points", "triangles"):
        assert np.array_equal(getattr(one.surface, name), getattr(other.surface, name))
        assert getattr(one.surface, name).dtype == getattr(other.surface, name).dtype
    recovery = one.surface.recovery
    assert np.all(np.abs(other.surface.recovery - recovery) <= 1e-3 * np.abs(recovery).max(axis=(0, 1)))


def test_round_trip_is_exact_and_repeatable(element, path, tmp_path):
    loaded = prs.SuperElement.load(path)
    assert_same(element, loaded)
    loaded.save(tmp_path / "again.npz")
    assert path.read_bytes() == (tmp_path / "again.npz").read_bytes()
    assert sorted(each.name for each in tmp_path.iterdir()) == ["again.npz", "part.npz"]


def test_travelling_round_trip_is_exact(tmp_path):
    travel = {"joint": "slide", "along": (1.0, 0.0, 0.0), "stations": (0.1, 0.2, 0.3, 0.4)}
    contact = Interface.model_validate({"set": "z1", "box": {"x": (-0.05, 0.05)}, "travel": travel})
    model = steel(box((0.5, 0.1, 0.08), (10, 2, 1)))
    element = reduce_travelling(model, {"end": Interface(set="x0"), "contact": contact}, SETTINGS)
    storage.save(element, tmp_path / "rail.npz")
    loaded = storage.load(tmp_path / "rail.npz")
    assert isinstance(loaded, prs.TravellingElement)
    assert (loaded.joint, loaded.stations.tolist()) == ("slide", [0.1, 0.2, 0.3, 0.4])
    for one, other in zip(element.elements, loaded.elements, strict=True):
        assert_same(one, other)
    assert np.array_equal(element.at(0.27).stiffness, loaded.at(0.27).stiffness)
    with pytest.raises(prs.PartFileError, match="travels with joint slide"):
        prs.SuperElement.load(tmp_path / "rail.npz")


def huge(path: Path) -> None:
    """An array that says it has 1e20 entries."""
    draft = io.BytesIO()
    np.lib.format.write_array_header_1_0(draft, {"descr": "<f8", "fortran_order": False, "shape": (10**20,)})
    with zipfile.ZipFile(path, "w") as file:
        file.writestr("stiffness.npy", draft.getvalue())


def rewritten(path: Path, **changes: object) -> None:
    """Change arrays or header entries of a stored file; None leaves an array out."""
    with np.load(path) as file:
        arrays = {name: file[name] for name in file.files}
    header = json.loads(str(arrays["header"]))
    for name, value in changes.items():
        if name in header:
            header[name] = value
        else:
            arrays[name] = value
    arrays["header"] = np.array(json.dumps(header))
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})


@pytest.mark.parametrize(
    ("damage", "words"),
    [
        (lambda path: path.unlink(), "there is no such file"),
        (lambda path: path.write_bytes(path.read_bytes()[:-2000]), "damaged"),
        (lambda path: path.write_bytes(b"\x00" * 100), "damaged"),
        (lambda path: path.write_bytes(b""), "damaged"),
        (lambda path: path.write_bytes(pickle.dumps({"stiffness": 1})), "damaged"),
        (lambda path: np.savez(path, stiffness=np.eye(3)), "damaged"),
        (lambda path: np.savez(path, header=np.array({"format": 1}, dtype=object)), "damaged"),
        (lambda path: rewritten(path, mass=None), "damaged"),
        (lambda path: rewritten(path, mass=np.full((1, 14, 14), 1.0, dtype=object)), "damaged"),
        (lambda path: rewritten(path, mass=np.ones((1, 3, 3))), "mass has shape"),
        (lambda path: rewritten(path, mass=np.full((1, 14, 14), np.nan)), "not finite numbers"),
        (lambda path: rewritten(path, nodes=["a"]), "positions has shape"),
        (lambda path: rewritten(path, version=99), "format version 99, this program reads 3"),
        (lambda path: rewritten(path, format="something"), "is 'something', expected"),
        (lambda path: path.write_text("hello"), "is no .npz file"),
        (lambda path: rewritten(path, n_modes=2.5), "n_modes"),
        (lambda path: rewritten(path, n_modes=True), "n_modes"),
        (lambda path: rewritten(path, grounded=0), "grounded"),
        (lambda path: rewritten(path, nodes="ab"), "nodes"),
        (lambda path: rewritten(path, labels=list(range(14))), "labels"),
        (lambda path: rewritten(path, provenance=None), "provenance"),
        (lambda path: rewritten(path, stations=np.array([0.0, 1.0])), "no joint for its stations"),
        (lambda path: rewritten(path, triangles=np.array([[0, 1, 100000]])), "triangles are of no point"),
        (lambda path: rewritten(path, recovery=np.zeros((1, 4, 3, 3))), "recovery has shape"),
        (lambda path: np.savez(path, header=np.array("[" * 100000)), "damaged"),
        (lambda path: huge(path), "damaged"),
    ],
)
def test_damaged_files_are_named(path, damage, words):
    damage(path)
    with pytest.raises(prs.PartFileError, match=words) as error:
        prs.SuperElement.load(path)
    assert error.value.path == path


def test_writers_at_the_same_time_do_not_meet(element, tmp_path):
    path = tmp_path / "part.npz"
    with ThreadPoolExecutor(4) as pool:
        list(pool.map(lambda _: element.save(path), range(12)))
    assert_same(element, prs.SuperElement.load(path))
    assert [each.name for each in tmp_path.iterdir()] == ["part.npz"]
    assert path.stat().st_mode & 0o444 == 0o444


def test_a_place_that_cannot_be_written(element, tmp_path):
    (tmp_path / "file").write_text("in the way")
    with pytest.raises(prs.PartFileError, match="cannot be written"):
        element.save(tmp_path / "file" / "part.npz")
