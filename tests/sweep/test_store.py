"""A folder of pieces: nothing finished is lost, torn or computed twice, whatever happens to the process."""

import json
import logging
import os
import random
import signal
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import xarray

import prs_model as prs
from prs_model.errors import PrsError
from prs_model.sweep.plan import Plan
from prs_model.sweep.poses import poses_of
from prs_model.sweep.request import Request
from prs_model.sweep.stored import store as stores
from prs_model.sweep.stored.identity import identity
from prs_model.sweep.stored.lazy import lazy
from prs_model.sweep.stored.store import Store, opened, piece_length
from tests.sweep.stand_in import RUN, SHAPE, StandIn, evaluated, processes, results, run, run_killed_before_renaming

SIZE = SHAPE[0] * SHAPE[1]
FEW = (5,)  # poses, a piece each


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return tmp_path / "run"


def started(work: Callable[..., None], folder: Path, plan: StandIn) -> Any:
    """A process at work."""
    process = processes().Process(target=work, args=(folder, plan))
    process.start()
    return process


def sound_pieces(folder: Path) -> set[tuple[int, int]]:
    """The poses of every piece in a folder, each of which has to be right."""
    found = set()
    for path in folder.glob("piece-*"):
        with np.load(path) as file:
            start, stop = json.loads(str(file["header"]))["poses"]
            for name, values in results(start, stop).items():
                np.testing.assert_array_equal(file[name], values)
        found.add((start, stop))
    return found


def gathered(folder: Path, shape: tuple[int, ...] = SHAPE) -> stores.Block:
    with opened(folder, RUN, shape) as store:
        return store.gather()


def assert_same(block: stores.Block, expected: stores.Block) -> None:
    assert block.keys() == expected.keys()
    for name, values in expected.items():
        assert block[name].tobytes() == values.tobytes()
        assert block[name].dtype == values.dtype


def test_killed_ten_times_at_random_moments_and_resumed(folder: Path, tmp_path: Path) -> None:
    plan = StandIn(tmp_path / "journal", seconds=0.01)
    moments = random.Random(20)
    finished: set[tuple[int, int]] = set()
    for _ in range(10):
        lines = len(evaluated(plan.journal))
        process = started(run, folder, plan)
        pieces = moments.randint(1, 5)
        while process.is_alive() and len(evaluated(plan.journal)) < lines + pieces:
            time.sleep(0.001)
        time.sleep(moments.uniform(0.0, 0.04))
        process.kill()
        process.join()
        assert process.exitcode == -signal.SIGKILL
        assert not finished & set(evaluated(plan.journal)[lines:])
        assert finished <= sound_pieces(folder)
        finished = sound_pieces(folder)
    lines = len(evaluated(plan.journal))
    run(folder, plan)
    assert len(finished) >= 10
    assert finished.isdisjoint(evaluated(plan.journal)[lines:])
    assert_same(gathered(folder), results(0, SIZE))


def test_what_a_killed_process_left_half_written_goes_away(folder: Path, tmp_path: Path) -> None:
    process = started(run_killed_before_renaming, folder, StandIn(tmp_path / "journal"))
    process.join()
    assert process.exitcode == -signal.SIGKILL
    assert list(folder.glob(".plan.npz.*"))
    run(folder, StandIn(tmp_path / "journal"))
    names = {path.name for path in folder.iterdir() if not path.name.startswith("piece-")}
    assert names == {"run.json", "plan.npz", "lock"}
    assert_same(gathered(folder), results(0, SIZE))


@pytest.mark.parametrize("damage", ["cut", "empty", "flipped", "other", "text"])
def test_a_damaged_piece_is_computed_again(
    folder: Path, tmp_path: Path, damage: str, caplog: pytest.LogCaptureFixture
) -> None:
    plan = StandIn(tmp_path / "journal")
    run(folder, plan, FEW)
    plan.journal.unlink()
    path = folder / "piece-000003.npz"
    content = path.read_bytes()
    path.write_bytes(
        {
            "cut": content[:-100],
            "empty": b"",
            "flipped": content[:2000] + bytes([content[2000] ^ 1]) + content[2001:],
            "other": (folder / "piece-000002.npz").read_bytes(),
            "text": b"frequency, 12.3",
        }[damage]
    )
    with opened(folder, RUN, FEW) as store, pytest.raises(PrsError, match=r"000003.*(damaged|another).*run the sweep"):
        store.gather()
    with caplog.at_level(logging.WARNING, "prs_model"):
        run(folder, plan, FEW)
    assert "piece-000003.npz: damaged" in caplog.text
    assert evaluated(plan.journal) == [(3, 4)]
    assert_same(gathered(folder, FEW), results(0, 5))


def test_no_flipped_bit_goes_unseen(folder: Path, tmp_path: Path) -> None:
    with opened(folder, RUN, (3,)) as store:
        store.write(0, {"frequency": np.ones((1, 2))})
        path = folder / "piece-000000.npz"
        sound = path.read_bytes()
        for place in range(0, len(sound), 2):
            path.write_bytes(sound[:place] + bytes([sound[place] ^ 1 << place // 2 % 8]) + sound[place + 1 :])
            if 0 in store.finished():  # a date or an attribute in the archive
                np.testing.assert_array_equal(store.read(0)["frequency"], 1.0)


def test_the_plan_is_made_once(folder: Path) -> None:
    made = []

    def make() -> stores.Block:
        made.append(1)
        return {"nodes": np.arange(3.0), "names": np.array(["z", "nutation"])}

    for _ in range(3):
        with opened(folder, RUN, SHAPE) as store:
            assert_same(store.plan(make), {"nodes": np.arange(3.0), "names": np.array(["z", "nutation"])})
    assert len(made) == 1
    (folder / "plan.npz").write_bytes(b"PK")
    with opened(folder, RUN, SHAPE) as store:
        store.plan(make)
    assert len(made) == 2


def test_nothing_that_would_be_pickled_is_written(folder: Path) -> None:
    with opened(folder, RUN, SHAPE) as store:
        with pytest.raises(ValueError, match="allow_pickle"):
            store.plan(lambda: {"nodes": np.array([{}])})
        assert {path.name for path in folder.iterdir()} == {"run.json", "lock"}


def test_a_folder_of_another_run_is_refused(folder: Path, tmp_path: Path) -> None:
    run(folder, StandIn(tmp_path / "journal"), FEW)
    other = RUN.replace('"n_modes":6', '"n_modes":8')
    with pytest.raises(PrsError, match=r"run: holds another sweep \(request.n_modes: 8, stored 6\)"):
        opened(folder, other, FEW).__enter__()
    assert_same(gathered(folder, FEW), results(0, 5))


def test_what_a_piece_does_not_have_is_nan(folder: Path) -> None:
    with opened(folder, RUN, FEW) as store:
        for index in range(5):
            block = results(index, index + 1)
            if index in (0, 3):
                del block["vectors"]
            store.write(index, block)
        vectors = store.gather()["vectors"]
        np.testing.assert_array_equal(lazy(store)["vectors"].compute(), vectors)
    assert np.isnan(vectors).all(axis=(1, 2)).tolist() == [True, False, False, True, False]


def test_pieces_that_do_not_fit_together_are_told(folder: Path) -> None:
    with opened(folder, RUN, FEW) as store:
        for index in range(5):
            store.write(index, results(index, index + 1))
        store.write(4, {"frequency": np.ones((1, 7))})
        with pytest.raises(PrsError, match=r"piece-000004\.npz: 'frequency' differs from other pieces"):
            store.gather()


def test_a_folder_with_other_files_is_left_alone(tmp_path: Path) -> None:
    (tmp_path / "thesis.tex").write_text("")
    with pytest.raises(PrsError, match=r"thesis\.tex.*expected a new one"):
        opened(tmp_path, RUN, SHAPE).__enter__()
    assert [path.name for path in tmp_path.iterdir()] == ["thesis.tex"]


@pytest.mark.parametrize("content", ["", "[]", '{"run": 1}', '{"run":{},"format":"x","version":1,"poses_per_piece":3}'])
def test_a_damaged_beginning_is_told(folder: Path, content: str) -> None:
    folder.mkdir()
    (folder / "run.json").write_text(content)
    with pytest.raises(PrsError, match=r"run\.json: is not of a sweep that can be continued"):
        opened(folder, RUN, SHAPE).__enter__()


def test_a_place_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(PrsError, match="cannot be written"):
        opened(tmp_path / "file", RUN, SHAPE).__enter__()


def test_a_folder_without_a_name_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(PrsError, match="store: found '', expected the name of a folder"):
        prs.load_machine("hexapod").sweep(x=0.0, store="")
    assert not list(tmp_path.iterdir())


def test_a_system_without_locks_is_told(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "fcntl", None)
    with pytest.raises(PrsError, match=r"run: this system has no file locks \(fcntl\).*sweep without a folder"):
        opened(folder, RUN, SHAPE).__enter__()
    assert not list(folder.iterdir())


def test_a_finished_piece_is_tested_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    machine, z = prs.load_machine("hexapod"), np.linspace(0.089, 0.091, 5)
    expected = machine.sweep(z=z, store=tmp_path)
    tested: list[int] = []
    is_sound = Store._is_sound

    def journal(store: Store, index: int) -> bool:
        tested.append(index)
        return is_sound(store, index)

    monkeypatch.setattr(Store, "_is_sound", journal)
    told: list[tuple[int, int]] = []
    found = machine.sweep(z=z, store=tmp_path, progress=lambda *done: told.append(done))
    xarray.testing.assert_identical(found, expected)
    assert sorted(tested) == [0, 1, 2, 3, 4]
    assert not told


def test_one_process_at_a_time_and_a_killed_one_holds_nothing(folder: Path, tmp_path: Path) -> None:
    process = started(run, folder, StandIn(tmp_path / "journal", seconds=60.0))
    while not evaluated(tmp_path / "journal"):
        time.sleep(0.001)
    with pytest.raises(PrsError, match=f"in use by process {process.pid} on "):
        opened(folder, RUN, SHAPE).__enter__()
    process.kill()
    process.join()
    with opened(folder, RUN, SHAPE), pytest.raises(PrsError, match=f"in use by process {os.getpid()} on "):
        opened(folder, RUN, SHAPE).__enter__()


def test_results_of_other_poses_are_not_kept(folder: Path) -> None:
    with opened(folder, RUN, SHAPE) as store:
        with pytest.raises(PrsError, match=r"piece 2: found arrays of shapes .*expected 10 poses"):
            store.write(2, results(0, 5))
        assert not store.finished()


def test_a_disk_that_is_full_leaves_no_torn_piece(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    with opened(folder, RUN, SHAPE) as store:

        def full(descriptor: int) -> None:
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(os, "fsync", full)
        with pytest.raises(PrsError, match=r"piece-000000\.npz: cannot be written \(No space left on device\)"):
            store.write(0, results(0, 10))
        assert {path.name for path in folder.iterdir()} == {"run.json", "lock"}


@pytest.mark.parametrize("shape", [(1,), (3,), (63,), (100_000,), (4, 1), (1, 100, 3600), (8, 80), (5, 700_000)])
def test_pieces_cover_every_pose_once(shape: tuple[int, ...]) -> None:
    size, length = int(np.prod(shape)), piece_length(shape)
    spans = list(Store(Path(), RUN, size, length).chunks.values())
    assert [start for start, _ in spans] == [0, *(stop for _, stop in spans[:-1])]
    assert spans[-1][1] == size
    assert max(stop - start for start, stop in spans) <= stores.MOST


def test_results_are_read_when_they_are_asked_for(folder: Path, tmp_path: Path) -> None:
    run(folder, StandIn(tmp_path / "journal"))
    with opened(folder, RUN, SHAPE) as store:
        arrays = lazy(store)
        assert store.layout()["frequency"] == ((6,), "<f8")
    (folder / "piece-000063.npz").unlink()
    frequency = arrays["frequency"].reshape(*SHAPE, 6)
    np.testing.assert_array_equal(frequency[2, 7].compute(), results(167, 168)["frequency"][0])
    np.testing.assert_array_equal(arrays["reason"], results(0, SIZE)["reason"])
    with pytest.raises(PrsError, match=r"piece-000063\.npz: there is no such piece"):
        arrays["vectors"].compute()


def test_large_results_stay_where_they_are(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    machine = prs.load_machine("hexapod")
    axes = {"z": np.linspace(0.089, 0.091, 3), "x": np.linspace(0.0, 1e-3, 4)}
    asked: Any = {**axes, "n_modes": 3, "quantities": ("frequency", "static_compliance", "identity")}
    expected = machine.sweep(**asked)
    monkeypatch.setattr("prs_model.sweep.stored.lazy.IN_MEMORY", 0)
    found = machine.sweep(**asked, store=tmp_path / "run")
    assert found["static_compliance"].chunks is not None
    found.to_netcdf(tmp_path / "map.nc", engine="h5netcdf")
    with xarray.open_dataset(tmp_path / "map.nc", engine="h5netcdf") as written:
        xarray.testing.assert_equal(written, expected)


def test_pieces_without_a_reachable_pose_fit_in(tmp_path: Path) -> None:
    machine = prs.load_machine("hexapod")
    asked: Any = {"z": np.r_[0.15, 0.16, np.linspace(0.089, 0.091, 70), 0.2], "quantities": "identity", "n_modes": 2}
    found = machine.sweep(**asked)
    xarray.testing.assert_identical(machine.sweep(**asked, store=tmp_path), found)
    assert (found["identity"] == 0).all("mode").values.tolist() == [True] * 2 + [False] * 70 + [True]


def test_an_interrupted_sweep_goes_on(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    machine = prs.load_machine("hexapod")
    asked: Any = {"x": np.linspace(-1e-3, 1e-3, 20), "rz": np.linspace(-0.01, 0.01, 25), "n_modes": 3}
    expected = machine.sweep(**asked)
    begun: list[int] = []
    evaluate = Plan.evaluate

    def journal(plan: Plan, start: int, stop: int) -> stores.Block:
        begun.append(start)
        return evaluate(plan, start, stop)

    def interrupt(done: int, size: int) -> None:
        if done > size / 3:
            raise KeyboardInterrupt

    monkeypatch.setattr(Plan, "evaluate", journal)
    with pytest.raises(KeyboardInterrupt):
        machine.sweep(**asked, store=tmp_path, progress=interrupt)
    kept = {int(path.stem.removeprefix("piece-")) for path in tmp_path.glob("piece-*")}
    begun.clear()
    monkeypatch.setattr("prs_model.sweep.run.make_plan", None)  # it was kept
    found = machine.sweep(**asked, store=tmp_path)
    xarray.testing.assert_identical(found, expected)
    length = json.loads((tmp_path / "run.json").read_text())["poses_per_piece"]
    assert len(kept) > 10
    assert not kept & {start // length for start in begun}


def test_a_run_is_known_by_everything_that_decides_it() -> None:
    machine = prs.load_machine("hexapod")

    def known_by(machine: prs.Machine = machine, request: Request = Request(), **axes: Any) -> str:  # noqa: B008
        return identity(machine, poses_of(machine, {"z": [0.5, 0.51], **axes}, None), request)

    first = known_by()
    assert first == known_by(prs.load_machine("hexapod"))
    others = [
        known_by(machine.replace({"bodies.platform.options.mass": 11.0})),
        known_by(request=Request(n_modes=7)),
        known_by(request=Request(tolerance=1e-7)),
        known_by(z=[0.5, 0.52]),
        known_by(z=[0.5, np.nextafter(0.51, 1.0)]),
        known_by(x=[0.0, 0.01]),
    ]
    assert len({first, *others}) == 7
