"""One machine on one page: what the sliders ask is solved, shown and animated, until it ends."""

from __future__ import annotations

import logging
from threading import Event
from time import monotonic
from typing import TYPE_CHECKING

from ..errors import PrsError
from ..machine import Machine
from .answer import Answer, Question, Scope, answer
from .page import Page
from .reshaping import Reshaping
from .scene import Scene

if TYPE_CHECKING:
    import viser

_FRAME = 1.0 / 15.0  # s
_REBUILDING = "Springs changed; the parts are being rebuilt for them, and figures will settle."
_NOT_REBUILT = "Springs changed; the parts could not be rebuilt for them and keep the shapes they had."
_log = logging.getLogger(__name__)


class Session:
    """The latest question counts: those that a slider has left behind are never solved.

    Springs follow a slider at once, on the parts as they are; parts that are shaped by their joints follow.
    """

    def __init__(self, server: viser.ViserServer, machine: Machine, start: Answer, scope: Scope):
        self.server, self.machine, self.scope = server, machine, scope
        self.found, self.solved = start, 1
        self.parts = Reshaping(machine, start.question.factors)
        self.asked, self.turned = Event(), Event()
        self.scene = Scene(server, start.modes)
        self.page = Page(server.gui, machine, start, scope, self.asked.set, self.turned.set)

    @property
    def address(self) -> str:
        """Where a browser on this computer finds the page."""
        return f"http://{self.server.get_host()}:{self.server.get_port()}"

    def run(self, stop: Event) -> None:
        """Answer and animate until `stop` is set."""
        self.turned.set()
        begun = monotonic()
        while not stop.is_set():
            frame = monotonic()
            self._collect_parts()
            if self.asked.is_set():
                self._solve()
            self._draw(frame - begun)
            self.asked.wait(max(0.0, frame + _FRAME - monotonic()))

    def close(self) -> None:
        """End what runs in the background."""
        self.parts.close()

    def _collect_parts(self) -> None:
        try:
            if self.parts.arrived():
                self.asked.set()
        except Exception as error:
            self._refuse(error)

    def _solve(self) -> None:
        self.asked.clear()
        question = self.page.question()
        self.parts.ask(question.factors)
        try:
            self.found = answer(self.machine, self.parts.parts, question, self.scope)
        except Exception as error:
            self._refuse(error)
            return
        self.solved += 1
        self.page.show(self.found, self._note(question))
        self.turned.set()

    def _refuse(self, error: Exception) -> None:
        """Go on with the last answer. What is not the input's fault goes to the log in full."""
        if isinstance(error, PrsError):
            self.page.refuse(str(error), self.found)
            return
        _log.error("an answer failed", exc_info=error)
        self.page.refuse(f"This failed unexpectedly ({type(error).__name__}: {error}).", self.found)

    def _note(self, question: Question) -> str:
        """What is still to be said of the parts."""
        if self.parts.suit(question.factors):
            return ""
        return _NOT_REBUILT if self.parts.failed(question.factors) else _REBUILDING

    def _draw(self, seconds: float) -> None:
        turned = self.turned.is_set()
        if turned:
            self.turned.clear()
            self.scene.show(self.found.modes, self.page.mode_drawn(len(self.found.modes.frequencies)))
        if turned or (self.page.animate.value and self.server.get_clients()):
            self.scene.deform(self.page.share(seconds))
