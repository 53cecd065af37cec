"""Pieces on several worker processes: the same results, whoever dies on the way."""

import importlib
import os
import signal
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import prs_model as prs
from prs_model.errors import PrsError
from prs_model.sweep import cluster as clusters
from prs_model.sweep.stored.store import Block, Store, opened
from tests.sweep.stand_in import RUN, SHAPE, StandIn, evaluated, processes, results
from tests.sweep.test_store import assert_same

dask = pytest.importorskip("dask")
distributed = pytest.importorskip("distributed")

SIZE = SHAPE[0] * SHAPE[1]


@pytest.fixture(scope="module")
def client() -> Iterator[distributed.Client]:
    """A cluster of three worker processes on this computer."""
    processes()  # one after another from a process that has everything loaded
    with (
        dask.config.set({"distributed.scheduler.allowed-failures": 1}),
        dask.config.set({"distributed.worker.multiprocessing-method": "forkserver"}),
        distributed.LocalCluster(n_workers=3, threads_per_worker=1, dashboard_address=":0") as cluster,
        distributed.Client(cluster, set_as_default=False) as client,
    ):
        yield client


def test_a_worker_killed_during_a_sweep_changes_nothing(
    client: distributed.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    machine = prs.load_machine("hexapod").replace({"bodies.platform.options.mass": 1.1})
    asked: Any = {"x": np.linspace(-1e-3, 1e-3, 20), "rz": np.linspace(-0.01, 0.01, 25), "n_modes": 3}
    expected = machine.sweep(**asked)
    written: list[int] = []
    write, victims = Store.write, list(client.run(os.getpid).values())[:1]

    def journal(store: Store, index: int, block: Block) -> None:
        written.append(index)
        write(store, index, block)
        if len(written) == 15:
            os.kill(victims[0], signal.SIGKILL)

    monkeypatch.setattr(Store, "write", journal)
    found = machine.sweep(**asked, store=tmp_path / "run", cluster=client)
    assert expected.identical(found)
    assert sorted(written) == list(range(len(written)))
    assert len(written) > 50
    assert victims[0] not in client.run(os.getpid).values()


def test_a_run_begun_here_is_completed_there(client: distributed.Client, tmp_path: Path) -> None:
    plan = StandIn(tmp_path / "journal")
    with opened(tmp_path / "run", RUN, SHAPE) as store:
        for index in (3, 17):
            store.write(index, plan.evaluate(*store.chunks[index]))
        plan.journal.unlink()
        for index, block in clusters.evaluate(client.scheduler.address, plan, store.unfinished()):
            store.write(index, block)
        assert_same(store.gather(), results(0, SIZE))
        assert len(evaluated(plan.journal)) == len(store.chunks) - 2


def plugins_of(client: distributed.Client) -> list[str]:
    """The plug-ins that workers have, and that new ones would get."""
    there = client.run(lambda dask_worker: list(dask_worker.plugins))
    coming = client.run_on_scheduler(lambda dask_scheduler: list(dask_scheduler.worker_plugins))
    return [*coming, *(name for names in there.values() for name in names)]


@dataclass(frozen=True)
class Failing:
    """Fails in the way asked for."""

    how: str

    def evaluate(self, start: int, stop: int) -> Block:
        if self.how == "killed":
            os.kill(os.getpid(), signal.SIGKILL)
        raise PrsError(f"poses {start} to {stop}: they cannot be had")


def test_what_a_pose_raises_arrives_and_the_cluster_is_clean(client: distributed.Client, tmp_path: Path) -> None:
    with pytest.raises(PrsError, match="they cannot be had"):
        list(clusters.evaluate(client, Failing("raises"), {0: (0, 10), 1: (10, 20)}))
    assert not any("sweep" in name for name in plugins_of(client))


def test_what_is_no_cluster_is_told() -> None:
    plan = StandIn(Path(os.devnull))
    with pytest.raises(PrsError, match=r"cluster: found 7, expected .*tcp://host:8786"):
        list(clusters.evaluate(7, plan, {0: (0, 1)}))
    soon = dask.config.set({"distributed.comm.timeouts.connect": "0.3s"})
    with soon, pytest.raises(PrsError, match=r"no scheduler of Dask answers at 'tcp://127\.0\.0\.1:9'"):
        list(clusters.evaluate("tcp://127.0.0.1:9", plan, {0: (0, 1)}))


def test_a_cluster_without_workers_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(clusters, "PATIENCE", 0.2)
    plan = StandIn(Path(os.devnull))
    with (
        distributed.LocalCluster(n_workers=0, dashboard_address=":0") as cluster,
        pytest.raises(PrsError, match=r"it had no workers for 0\.2 s"),
    ):
        list(clusters.evaluate(cluster, plan, {0: (0, 1)}))


def test_workers_without_the_program_are_told(
    client: distributed.Client, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "only_here.py").write_text("class Plan:\n    def evaluate(self, start, stop):\n        return {}\n")
    monkeypatch.syspath_prepend(tmp_path)
    plan = importlib.import_module("only_here").Plan()
    with pytest.raises(PrsError, match=r"cannot load the sweep .*only_here.*install the same prs-model"):
        list(clusters.evaluate(client, plan, {0: (0, 10)}))
    assert not any("sweep" in name for name in plugins_of(client))


def test_memory_does_not_grow_with_the_number_of_pieces(client: distributed.Client, tmp_path: Path) -> None:
    plan = StandIn(tmp_path / "journal")
    ahead = 0
    chunks = {index: (index, index + 1) for index in range(60)}
    for count, (index, block) in enumerate(clusters.evaluate(client, plan, chunks)):
        np.testing.assert_array_equal(block["frequency"], results(index, index + 1)["frequency"])
        ahead = max(ahead, len(evaluated(plan.journal)) - count)
    assert ahead <= 20 < len(chunks)


def test_a_piece_that_kills_every_worker_is_told(client: distributed.Client) -> None:
    with pytest.raises(PrsError, match=r"workers died over one piece.*more memory"):
        list(clusters.evaluate(client, Failing("killed"), {0: (0, 10)}))
    plan_works = dict(clusters.evaluate(client, StandIn(Path(os.devnull)), {0: (0, 10)}))
    assert_same(plan_works[0], results(0, 10))
