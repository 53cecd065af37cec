"""A plan that is known by heart, for tests of what is done with plans; run in processes that are killed."""

from __future__ import annotations

import json
import multiprocessing
import os
import signal
import time
from dataclasses import dataclass
from multiprocessing import forkserver
from multiprocessing.context import ForkServerContext
from pathlib import Path

import numpy as np

from prs_model.sweep.stored.store import Block, opened

SHAPE = (8, 80)
RUN = json.dumps({"machine": "stand-in", "request": {"n_modes": 6}}, sort_keys=True, separators=(",", ":"))


@dataclass(frozen=True)
class StandIn:
    """Results that tell the pose they are of. journal: a file that tells what was evaluated; seconds: for each piece"""

    journal: Path
    seconds: float = 0.0

    def evaluate(self, start: int, stop: int) -> Block:
        with self.journal.open("a") as journal:
            journal.write(f"{start} {stop}\n")
        time.sleep(self.seconds)
        return results(start, stop)


def processes() -> ForkServerContext:
    """Where processes come from: forked, with everything loaded, so that they are at work at once."""
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(
        ["pinocchio", "distributed", "prs_model.sweep.kernels_jit", "prs_model.machine", __name__]
    )
    forkserver.ensure_running()
    return context


def results(start: int, stop: int) -> Block:
    poses = np.arange(start, stop)
    frequency = 10.0 + np.sqrt(poses[:, None] + np.arange(6.0))
    frequency[poses % 7 == 3] = np.nan
    vectors = np.cos(poses[:, None, None] * np.ones((1, 20, 60)))
    return {"frequency": frequency, "vectors": vectors, "reason": (poses % 7 == 3).astype(np.int16)}


def evaluated(journal: Path) -> list[tuple[int, int]]:
    """What the journal tells, line by line."""
    lines = journal.read_text().splitlines() if journal.exists() else []
    return [(int(start), int(stop)) for start, stop in (line.split() for line in lines)]


def run(folder: Path, plan: StandIn, shape: tuple[int, ...] = SHAPE) -> None:
    """Evaluate what is unfinished, one piece after another."""
    with opened(folder, RUN, shape) as store:
        store.plan(lambda: {"nodes": np.arange(3.0)})
        for index, span in store.unfinished().items():
            store.write(index, plan.evaluate(*span))


def run_killed_before_renaming(folder: Path, plan: StandIn) -> None:
    """As `run`, but the process is killed when its second file is written in full and has its other name yet."""
    rename = os.replace
    renamed = []

    def replace(source: str, target: Path) -> None:
        if len(renamed) == 1:
            os.kill(os.getpid(), signal.SIGKILL)
        renamed.append(target)
        rename(source, target)

    os.replace = replace  # type: ignore[assignment]
    run(folder, plan)
