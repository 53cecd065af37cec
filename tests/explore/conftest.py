"""A page served from a thread, as Ctrl-C would find it in the command, and a browser without a window."""

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from shutil import which
from threading import Event, Thread
from typing import Any

import pytest

import prs_model as prs
from prs_model.explore.server import serving
from prs_model.explore.session import Session

Serve = Callable[..., Session]

_WITHOUT_GPU = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]


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


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    """Chromium, driven by playwright, of which one runs at a time."""
    playwright = pytest.importorskip("playwright.sync_api", reason="drives the browser")
    path = which("chromium") or which("chromium-browser") or which("google-chrome")
    if path is None:
        pytest.skip("no Chromium is installed")
    with playwright.sync_playwright() as driver:
        running = driver.chromium.launch(executable_path=path, args=_WITHOUT_GPU)
        yield running
        running.close()
