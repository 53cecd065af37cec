"""A sweep from beginning to end: plan, pieces on all cores, dataset."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import FIRST_COMPLETED, Future, ThreadPoolExecutor, wait
from contextlib import ExitStack
from importlib.util import find_spec
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from .dataset import to_dataset
from .plan import Plan, make_plan
from .poses import Poses
from .quantities import BOUNDED, DENSE, INTERPOLATED, UNREACHABLE, Block
from .request import Request
from .stored.identity import identity
from .stored.lazy import results
from .stored.room import check_room
from .stored.store import Store, blank, opened, piece_length
from .threads import workers
from .truth import check_damping

if TYPE_CHECKING:
    import xarray

    from ..machine import Machine

Progress = Callable[[int, int], None]
"""Called with the number of poses that are done and of all, now and then."""

Spans = Mapping[int, tuple[int, int]]
"""Pieces by number: the poses start .. stop - 1."""

_UNDER_WAY = 32  # pieces at a time, which bounds memory
_SOLVED = 256  # poses in a piece at most, where they are solved one by one: an interruption waits for pieces begun


def sweep(
    machine: Machine,
    poses: Poses,
    request: Request,
    progress: Progress | None = None,
    store: str | Path | None = None,
    cluster: object = None,
) -> xarray.Dataset:
    """What is asked at all poses, as a dataset; see Machine.sweep."""
    check_damping(machine, request)
    if store is None or find_spec("dask") is None:
        check_room(machine, poses, request)
    identity_text = identity(machine, poses, request) if store is not None else ""
    with ExitStack() as held:
        pool = held.enter_context(workers())
        kept = held.enter_context(opened(store, identity_text, poses.shape)) if store is not None else None
        plan = _plan(machine, poses, request, pool, kept)
        spans = _spans(plan) if kept is None else kept.unfinished()
        block = _whole(plan, spans, _pieces(plan, spans, kept, pool, cluster), kept, progress)
        return to_dataset(machine, poses, request, block, certificate(plan, block))


def _plan(machine: Machine, poses: Poses, request: Request, pool: ThreadPoolExecutor, kept: Store | None) -> Plan:
    if kept is None:
        return make_plan(machine, poses, request, pool)
    arrays = kept.plan(lambda: make_plan(machine, poses, request, pool).to_arrays())
    return Plan.from_arrays(machine, poses, request, arrays)


def _spans(plan: Plan) -> Spans:
    """All pieces of a sweep that is not kept."""
    size, length = plan.poses.size, piece_length(plan.poses.shape)
    if plan.found is None:
        length = min(length, _SOLVED)
    return {k: (start, min(start + length, size)) for k, start in enumerate(range(0, size, length))}


def _pieces(
    plan: Plan, spans: Spans, kept: Store | None, pool: ThreadPoolExecutor, cluster: object
) -> Iterator[tuple[int, Block]]:
    """What is not finished yet, by the first pose of each piece, as it becomes ready."""
    if cluster is None:
        evaluated = _evaluated(plan, spans, pool)
    else:
        from .cluster import evaluate

        evaluated = evaluate(cluster, plan, spans)
    for index, block in evaluated:
        if kept is not None:
            kept.write(index, block)
        yield spans[index][0], block


def _whole(
    plan: Plan, spans: Spans, pieces: Iterator[tuple[int, Block]], kept: Store | None, progress: Progress | None
) -> Block:
    """All results, from the pieces as they come or, where these are kept, from their files."""
    size, block = plan.poses.size, {}
    done = size - sum(stop - start for start, stop in spans.values())
    for start, piece in pieces:
        done += len(piece["proof"])
        if kept is None:
            for name, values in piece.items():
                if name not in block:
                    block[name] = blank((size, *values.shape[1:]), values.dtype.str)
                block[name][start : start + len(values)] = values
        if progress is not None:
            progress(done, size)
    return block if kept is None else results(kept)


def certificate(plan: Plan, block: Mapping[str, Any]) -> dict[str, str | int | float]:
    """What was proved of a sweep, and how, in words and numbers."""
    proof = block["proof"]
    facts: dict[str, str | int | float] = {
        "how": plan.why,
        "poses_interpolated": int(np.sum(proof == INTERPOLATED)),
        "poses_bounded": int(np.sum(proof == BOUNDED)),
        "poses_solved": int(np.sum(proof == DENSE)),
        "poses_unreachable": int(np.sum(proof == UNREACHABLE)),
    }
    bound = float(np.nan_to_num(block["bound"]).max()) if plan.found is not None else 0.0
    if bound > 0.0:  # it has none where no pose is reachable
        facts["relative_error_bound"] = bound
    return facts


def _evaluated(plan: Plan, spans: Spans, pool: ThreadPoolExecutor) -> Iterator[tuple[int, Block]]:
    """Pieces by number, as they become ready; a few under way at a time."""
    waiting = iter(spans.items())
    under_way: dict[Future[Block], int] = {}
    while True:
        for index, (start, stop) in islice(waiting, _UNDER_WAY - len(under_way)):
            under_way[pool.submit(plan.evaluate, start, stop)] = index
        if not under_way:
            return
        for future in wait(under_way, return_when=FIRST_COMPLETED).done:
            yield under_way.pop(future), future.result()
