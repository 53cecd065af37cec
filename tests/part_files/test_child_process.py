"""A reader in a child process can do the caller no harm, and what became of it is said."""

import multiprocessing
from pathlib import Path

import pytest

import prs_model as prs
from prs_model.part_files import child_process, read_apart

READERS = "tests.part_files.readers"


@pytest.fixture
def part(tmp_path: Path) -> Path:
    path = tmp_path / "part.bin"
    path.write_bytes(b"0123456789")
    return path


@pytest.mark.parametrize(
    ("reader", "words"),
    [
        ("crashing", "its reader crashed: the file is damaged"),
        ("hanging", r"was not read within \d+ s: damaged"),
        ("greedy", "asks for far more memory than a file of its size can fill"),
        ("refusing", "line 3: found 'x', expected a number"),
        ("failing", r"damaged or of another kind \(KeyError: 'absent'\)"),
        ("leaving", "its reader crashed"),
        ("absent", r"its reader cannot be used \(AttributeError"),
    ],
)
def test_what_a_bad_reader_does_is_said(part, reader, words, monkeypatch):
    monkeypatch.setattr(child_process, "LEAST_SECONDS", 1.0)
    with pytest.raises(prs.PartFileError, match=words) as error:
        read_apart(f"{READERS}:{reader}", part)
    assert error.value.path == part
    assert read_apart(f"{READERS}:sound", part, factor=2.0)["bytes"] == 20.0


def test_what_it_prints_is_dropped(part, capfd):
    assert read_apart(f"{READERS}:talkative", part)["said"] == 1
    assert capfd.readouterr() == ("", "")


def test_a_module_that_is_not_there_names_its_extra(part):
    with pytest.raises(prs.MissingExtraError, match=r"pip install 'prs-model\[nastran\]'"):
        read_apart(f"{READERS}:sound", part, extra=("pyyeti", "nastran"), needs="no_such_module", factor=1.0)


def test_missing_and_empty_files_need_no_child(tmp_path):
    (tmp_path / "empty").touch()
    for name, words in (("none", "no such file"), ("empty", "is empty"), (".", "directory")):
        with pytest.raises(prs.PartFileError, match=words):
            read_apart(f"{READERS}:sound", tmp_path / name, factor=1.0)


def test_names_beside_the_part_are_not_imported(part, monkeypatch):
    (part.parent / "random.py").write_text("raise SystemExit('imported')\n")
    monkeypatch.chdir(part.parent)
    monkeypatch.setattr(child_process, "_folder", [])
    assert read_apart(f"{READERS}:sound", part, factor=1.0)["bytes"] == 10.0


def test_forks_of_the_caller_use_its_server(part):
    read_apart(f"{READERS}:sound", part, factor=1.0)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        sizes = pool.starmap(_size, [(part, factor) for factor in (1.0, 2.0, 3.0)])
    assert sizes == [10.0, 20.0, 30.0]


def _size(part: Path, factor: float) -> float:
    return float(read_apart(f"{READERS}:sound", part, factor=factor)["bytes"])
