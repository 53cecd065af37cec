"""The controls beside the machine, and what they say."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ..machine import Machine
from ..modes.drawn import AMPLITUDE
from ..readable import pose_text
from .answer import Answer, Question, Scope
from .controls import factor_sliders, pose_sliders
from .figures import add_plot, curves, frequency_table, paragraph
from .following import origins

if TYPE_CHECKING:
    import viser

_AMPLITUDE = 100.0 * AMPLITUDE  # % of the machine's size
_PERIOD = 2.0  # s, of the animation


class Page:
    """Sliders for the pose and the joints, the choice of the mode, and the answer in figures.

    asked: called when the machine is to be solved anew; turned: when another mode is to be drawn.
    """

    def __init__(
        self,
        gui: viser.GuiApi,
        machine: Machine,
        start: Answer,
        scope: Scope,
        asked: Callable[[], None],
        turned: Callable[[], None],
    ):
        self.machine, self.start, self.scope = machine, start, scope
        self.status, self.table = gui.add_html(""), gui.add_html("")
        self.pose = pose_sliders(gui, machine, start.question.pose, asked)
        self.factors = factor_sliders(gui, machine, asked)
        count = len(start.modes.frequencies)
        with gui.add_folder("Mode shape"):
            self.mode = gui.add_slider("mode number", 1, count, 1, 1)
            self.amplitude = gui.add_slider("amplitude [%]", 0.0, 20.0, 0.5, _AMPLITUDE, hint="of the machine's size")
            self.animate = gui.add_checkbox("animate", True)
        for control in (self.mode, self.amplitude, self.animate):
            control.on_update(lambda _: turned())
        self.plot = None if start.response is None else add_plot(gui, start.response, _damping_note(scope))
        self.show(start)

    def question(self) -> Question:
        """What the sliders ask for."""
        pose = {name: slider.value for name, slider in self.pose.items()}
        factors = {entry: float(slider.value) for entry, slider in self.factors.items()}
        return Question({**self.start.question.pose, **pose}, factors)

    def mode_drawn(self, count: int) -> int:
        """The mode chosen, counted from 0, of so many that there are."""
        return min(int(self.mode.value), count) - 1

    def share(self, seconds: float) -> float:
        """Displacement over the machine's size at a time of the animation; the largest where that is paused."""
        phase = np.sin(2.0 * np.pi * seconds / _PERIOD) if self.animate.value else 1.0
        return float(0.01 * self.amplitude.value * phase)

    def show(self, found: Answer, note: str = "") -> None:
        """The figures of an answer, and what is to be said of them."""
        self.status.content = paragraph(list(filter(None, [self._place(found), note])))
        self.table.content = frequency_table(found.modes, origins(self.scope.start, found.modes))
        if found.response is not None and self.plot is not None:
            self.plot.data = curves(found.response)

    def refuse(self, reason: str, last: Answer) -> None:
        """Say why the machine stays where it was."""
        self.status.content = paragraph([reason, f"The machine stays at {self._place(last)}."], "alert")

    def _place(self, found: Answer) -> str:
        return pose_text(found.question.pose, self.machine.kinematics.task.coordinates) or "its only pose"


def _damping_note(scope: Scope) -> str:
    return "damping as described" if scope.damping is None else f"damping ratio {scope.damping:g}"
