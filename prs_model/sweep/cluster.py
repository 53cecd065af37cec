"""A sweep on a Dask cluster: pieces become tasks, the plan goes to every worker once.

The plan is a plug-in of the workers, which the scheduler also hands to workers that join later, such as those started
in place of one that died. The pieces of a worker that died are evaluated by others. A few pieces more than there are
threads are under way at any time, so that memory does not grow with the number of poses.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from itertools import islice
from typing import Any, Protocol
from uuid import uuid4

from ..errors import MissingExtraError, PrsError, short
from .stored.store import Block

try:
    import distributed
    from distributed import Client, Future, get_worker
    from distributed.comm.core import CommClosedError
    from distributed.diagnostics.plugin import WorkerPlugin
except ImportError as error:
    raise MissingExtraError("distributed", "cluster", "a sweep on a cluster") from error

PATIENCE = 60.0  # s without any worker

_ADDRESS = re.compile(r"[a-z]+://\S+|[^\s:/]+:\d+")


class Plan(Protocol):
    """What evaluates poses. It travels to the workers, so it holds no locks, files or compiled code of its own."""

    def evaluate(self, start: int, stop: int) -> Block:
        """The results of the poses start .. stop - 1."""


def evaluate(
    cluster: Client | str | Any, plan: Plan, chunks: Mapping[int, tuple[int, int]]
) -> Iterator[tuple[int, Block]]:
    """The results of the chunks (start, stop) by their numbers, as they become ready.

    cluster: a `distributed.Client`, the address of a scheduler (``tcp://host:8786``) or a cluster object of Dask's.
    Raises what the evaluation of a pose raises, and PrsError for a cluster that cannot be reached, has no workers for a
    minute, went away, or whose workers die over one chunk as often as it allows.
    """
    with _client(cluster) as client, _on_workers(client, plan) as name:
        waiting = iter(chunks.items())
        under_way: dict[Future[Any], int] = {}
        try:
            while True:
                room = max(0, _most_under_way(client) - len(under_way))
                for index, span in islice(waiting, room):
                    under_way[client.submit(_evaluated, name, *span, key=f"{name}-{index}", pure=False)] = index
                if not under_way:
                    return
                for future in _completed(client, list(under_way)):
                    yield under_way.pop(future), _result(future)
        except (CommClosedError, distributed.CancelledError) as error:
            raise PrsError(f"cluster: it went away, or cancelled the sweep ({short(error)}); run again") from error
        finally:
            with suppress(OSError):  # the cluster may be gone
                client.cancel(list(under_way))


class _PlanOnWorker(WorkerPlugin):
    def __init__(self, plan: Plan):
        self.plan = plan


def _evaluated(name: str, start: int, stop: int) -> Block | None:
    """Runs on a worker. None where the plan has been taken away, when a sweep was given up."""
    plugin = get_worker().plugins.get(name)
    return plugin.plan.evaluate(start, stop) if isinstance(plugin, _PlanOnWorker) else None


@contextmanager
def _client(cluster: Client | str | Any) -> Iterator[Client]:
    """The caller's client, or one of our own for as long as it is needed."""
    if isinstance(cluster, Client):
        if cluster.asynchronous:
            raise PrsError("cluster: found an asynchronous client, expected one made without asynchronous=True")
        yield cluster
        return
    if not isinstance(cluster, str) and not hasattr(cluster, "scheduler_address"):
        expected = "expected a client or cluster of Dask, or the address of its scheduler such as tcp://host:8786"
        raise PrsError(f"cluster: found {cluster!r:.60}, {expected}")
    if isinstance(cluster, str) and not _ADDRESS.fullmatch(cluster):
        raise PrsError(f"cluster: found '{cluster}', expected the address of a Dask scheduler such as tcp://host:8786")
    try:
        client = Client(cluster, set_as_default=False)
    except (OSError, ValueError) as error:
        raise PrsError(f"cluster: no scheduler of Dask answers at '{cluster}' ({error})") from error
    with client:
        yield client


@contextmanager
def _on_workers(client: Client, plan: Plan) -> Iterator[str]:
    """The name under which every worker has the plan, present and future ones."""
    name = f"prs-model-sweep-{uuid4().hex}"
    try:
        _register(client, plan, name)
        yield name
    finally:
        with suppress(OSError, KeyError):  # the cluster may be gone, or no worker have it
            client.unregister_worker_plugin(name)


def _register(client: Client, plan: Plan, name: str) -> None:
    try:
        client.register_plugin(_PlanOnWorker(plan), name=name)
    except Exception as error:  # whatever a worker without the same packages makes of it
        remedy = "install the same prs-model, and what it needs, on every worker"
        raise PrsError(f"cluster: its workers cannot load the sweep ({short(error)}); {remedy}") from error


def _most_under_way(client: Client) -> int:
    """Enough that no thread waits for the next piece."""
    threads: Mapping[str, int] = client.nthreads()
    return 8 + 2 * sum(threads.values())


def _completed(client: Client, futures: list[Future[Any]]) -> set[Future[Any]]:
    """Those that are ready, at least one."""
    while True:
        try:
            with client.as_current():
                done: set[Future[Any]] = distributed.wait(futures, timeout=PATIENCE, return_when="FIRST_COMPLETED").done
            return done
        except distributed.TimeoutError:
            if not client.nthreads():
                raise PrsError(f"cluster: it had no workers for {PATIENCE:g} s; start some, and run again") from None


def _result(future: Future[Any]) -> Block:
    try:
        block: Block | None = future.result()
    except distributed.KilledWorker as error:
        died = f"{error.allowed_failures + 1} workers died over one piece, the last {error.last_worker.address}"
        raise PrsError(f"cluster: {died}; they need more memory, or their logs say why") from error
    if block is None:
        raise PrsError("cluster: a worker has no plan of the sweep; run again")
    return block
