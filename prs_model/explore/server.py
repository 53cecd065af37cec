"""Serving the page on this computer, and on it alone."""

from __future__ import annotations

import logging
import socket
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, redirect_stdout
from functools import partial
from importlib import import_module
from io import StringIO
from threading import Event
from typing import TYPE_CHECKING, Any, cast

from ..errors import MissingExtraError, PrsError
from ..machine import Machine
from .answer import Question, answer, scope_of
from .session import Session
from .stiffness import elastic_entries

if TYPE_CHECKING:
    import viser

PORT = 8080
_HOST = "127.0.0.1"
_log = logging.getLogger(__name__)


def explore(
    machine: Machine,
    pose: Mapping[str, float] | None = None,
    *,
    count: int = 8,
    port: int = PORT,
    browser: bool = False,
    tell: Callable[[str], object] = _log.info,
) -> int:
    """Serve a page with the machine and sliders for its pose and joints until Ctrl-C; how often it was solved.

    pose: where to start [m, rad], by default at the reference; count: how many modes are shown; port: of the loopback
    address, 0 for any that is free; browser: open the page in one; tell: what says where the page is, by default to the
    log. Needs the extra `viz`.
    Raises MissingExtraError, UnreachablePoseError for the pose at the start, PrsError for a port that cannot be had.
    """
    with serving(machine, pose, count=count, port=port) as session:
        tell(f"{machine.name} is at {session.address}; Ctrl-C ends it")
        if browser:
            _open(session.address)
        try:
            session.run(Event())
        except KeyboardInterrupt:
            _log.info("ended")
        return session.solved


@contextmanager
def serving(
    machine: Machine, pose: Mapping[str, float] | None = None, *, count: int = 8, port: int = PORT
) -> Iterator[Session]:
    """A session whose page is up; `Session.run` keeps it alive. See `explore`."""
    check_viser()
    port = check_port(port)
    factors = dict.fromkeys(elastic_entries(machine), 1.0)
    start = machine.configuration(**(pose or {})).pose
    scope = scope_of(machine, start, count)
    first = answer(machine, machine.parts, Question(start, factors), scope)
    server = _server(port, machine.description.file.title or machine.name)
    try:
        session = Session(server, machine, first, scope)
        try:
            yield session
        finally:
            session.close()
    finally:
        with _unheard():
            server.stop()


def check_viser() -> None:
    """Raises MissingExtraError where viser is not installed."""
    try:
        import viser  # noqa: F401
    except ImportError as error:
        raise MissingExtraError("viser", "viz", "exploring a machine") from error


def check_port(port: int) -> int:
    """The port, or one that is free for 0. Raises PrsError when the page could not be served there on this computer."""
    if not 0 <= port <= 65535:
        raise PrsError(f"port: found {port}, expected one from 1 to 65535, or 0 for any that is free")
    with socket.socket(socket.AF_INET, socket.SOCK_STREAM) as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((_HOST, port))
        except OSError as error:
            raise _no_port(port, error.strerror or str(error)) from error
        return int(probe.getsockname()[1])


def _server(port: int, label: str) -> viser.ViserServer:
    """Raises PrsError when another program takes the port just now: viser would go on to the next one unasked."""
    import viser

    with _unheard(), _foreign_pages_refused(port):
        server: Any = viser.ViserServer(host=_HOST, port=port, label=label, verbose=False)
        if port != server.get_port():
            server.stop()
            raise _no_port(port, "in use")
    server.request_share_url = _stay_here
    server.gui.configure_theme(control_width="large", show_share_button=False, show_logo=False)
    server.gui.main_panel.dock_right()
    return cast("viser.ViserServer", server)


@contextmanager
def _foreign_pages_refused(port: int) -> Iterator[None]:
    """Web sockets opened meanwhile accept the server's own pages alone.

    viser would let any page that the browser has open, wherever it comes from, move the sliders and read the answers.
    """
    websockets: Any = import_module("websockets.asyncio.server")
    serve = websockets.serve
    websockets.serve = partial(serve, origins=[f"http://{host}:{port}" for host in (_HOST, "localhost")])
    try:
        yield
    finally:
        websockets.serve = serve


def _stay_here(*_: object) -> None:
    """In place of viser's tunnel to the open network, which any page could ask for."""
    _log.warning("a page asked to be shared beyond this computer, which is not done")


@contextmanager
def _unheard() -> Iterator[None]:
    """Without viser's own lines on standard output, which belongs to results."""
    with redirect_stdout(StringIO()):
        yield


def _no_port(port: int, reason: str) -> PrsError:
    return PrsError(f"port {port} of {_HOST} cannot be had ({reason}); choose another, or 0 for any that is free")


def _open(address: str) -> None:
    import webbrowser

    if not webbrowser.open(address):
        _log.warning("no browser could be opened; open %s in one", address)
