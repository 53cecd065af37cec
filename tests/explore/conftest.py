"""A page served from a thread, as Ctrl-C would find it in the command."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from threading import Event, Thread
from typing import Any

import pytest

import prs_model as prs
from prs_model.explore.server import serving
from prs_model.explore.session import Session

Serve = Callable[..., Session]


@pytest.fixture
def serve() -> Iterator[Serve]:
    """Serves a machine at a free port until the test ends."""
    pytest.importorskip("viser", reason="the extra `viz`")
    with ExitStack() as stack:
        yield lambda machine, **how: stack.enter_context(_running(machine, **how))


@contextmanager
def _running(machine: prs.Machine, **how: Any) -> Iterator[Session]:
    stop = Event()
    with serving(machine, port=0, **how) as session:
        thread = Thread(target=session.run, args=(stop,))
        thread.start()
        try:
            yield session
        finally:
            stop.set()
            thread.join()
