"""Exports: what is refused before anything is written, and by whom files are written."""

import logging
from pathlib import Path

import pytest

import prs_model as prs
from prs_model import plugins
from prs_model.reduction.exports import check_writable, export
from prs_model.testing.element import plain_element


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_no_file_that_the_part_is_read_from_is_overwritten(tmp_path):
    """Neither by the file that is asked for nor by one of its companions, however its path is written."""
    for name in ("part.mtx", "other_dofs.txt"):
        (tmp_path / name).write_text("kept")
    keep = [tmp_path / "part.mtx", tmp_path / "other_dofs.txt"]
    with pytest.raises(prs.PartFileError, match=r"part\.mtx: the part is read from this file"):
        check_writable(tmp_path / ".." / tmp_path.name / "part.mtx", keep=keep)
    with pytest.raises(prs.PartFileError, match=r"other_dofs\.txt: the part is read from this file"):
        export(plain_element(), tmp_path / "other.mtx", keep=keep)
    assert names(tmp_path) == ["other_dofs.txt", "part.mtx"]
    assert (tmp_path / "other_dofs.txt").read_text() == "kept"
    export(plain_element(), tmp_path / "third.mtx", keep=keep)
    assert names(tmp_path) == ["other_dofs.txt", "part.mtx", "third.mtx", "third_dofs.txt", "third_mass.mtx"]


@pytest.mark.parametrize(
    ("name", "units", "words"),
    [
        ("part.npz", "mm-N-tonne-s", "files of suffix .npz are always in SI"),
        ("part.mtx", "foo", "units of part.mtx: found 'foo', expected length-force-mass-time"),
        ("part.stl", "m-N-kg-s", "found the suffix '.stl', expected one that a reducer writes: .mtx"),
        ("nowhere/part.npz", "m-N-kg-s", "there is no folder"),
        ("nowhere/part.op4", "m-N-kg-s", "nowhere/part.op4: there is no folder"),
    ],
)
def test_what_cannot_be_written_is_refused(tmp_path, name, units, words):
    with pytest.raises(prs.PrsError, match=words):
        check_writable(tmp_path / name, units=units)
    with pytest.raises(prs.PrsError, match=words):
        prs.export(plain_element(), tmp_path / name, units=units)
    assert names(tmp_path) == []


def test_only_elements_are_written(tmp_path):
    with pytest.raises(prs.PrsError, match="found NoneType, expected a SuperElement"):
        prs.export(None, tmp_path / "part.npz")


def test_two_writers_of_one_suffix_are_told(tmp_path, monkeypatch, caplog):
    """The first by name writes, as it did before the other one was installed."""
    monkeypatch.setattr(type(plugins.reducer("openfast")), "writes", (".npz",))
    with caplog.at_level(logging.WARNING, logger="prs_model"):
        check_writable(tmp_path / "part.mtx")
        assert not caplog.messages
        check_writable(tmp_path / "part.npz")
    assert caplog.messages == ["reducers 'npz' and 'openfast' both write .npz files: 'npz' does"]
