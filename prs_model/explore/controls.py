"""Sliders for the pose and for the stiffness of joints."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import floor, log10
from typing import TYPE_CHECKING, Any

from ..description.units import Units
from ..machine import Machine
from .stiffness import elastic_entries

if TYPE_CHECKING:
    import viser

UNITS = Units(length="mm", angle="deg")
SOFTEST, STIFFEST = 0.1, 4.0
_STEPS = 100  # at least so many along a slider of the pose


@dataclass(frozen=True)
class PoseSlider:
    """A slider in mm or degrees, and the factor [m, rad] of its unit."""

    slider: viser.GuiSliderHandle[float]
    factor: float

    @property
    def value(self) -> float:
        """[m, rad]"""
        return float(self.slider.value) * self.factor

    def move(self, value: float) -> None:
        """To a value [m, rad]."""
        _set(self.slider, _shown(value, self.factor))


def pose_sliders(
    gui: viser.GuiApi, machine: Machine, start: Mapping[str, float], changed: Callable[[], None]
) -> dict[str, PoseSlider]:
    """One for each coordinate that the workspace leaves free, within its bounds, and a button back to the start."""
    bounds = {name: (min(low, start[name]), max(high, start[name])) for name, (low, high) in machine.workspace.items()}
    free = {name: pair for name, pair in bounds.items() if pair[0] < pair[1]}
    if not free:
        return {}
    with gui.add_folder("Pose"):
        sliders = {name: _pose_slider(gui, machine, name, *pair, start[name]) for name, pair in free.items()}
        button = gui.add_button("Back to the start")
    for each in sliders.values():
        each.slider.on_update(lambda _: changed())

    def back(_: object) -> None:
        for name, each in sliders.items():
            each.move(start[name])
        changed()

    button.on_click(back)
    return sliders


def factor_sliders(
    gui: viser.GuiApi, machine: Machine, changed: Callable[[], None]
) -> dict[str, viser.GuiSliderHandle[float]]:
    """One for each entry of the joints that has some stiffness, and a button back to one."""
    entries = elastic_entries(machine)
    if not entries:
        return {}
    with gui.add_folder("Stiffness of joints, as described = 1"):
        sliders = {
            entry: gui.add_slider(f"{entry} ×", SOFTEST, STIFFEST, 0.05, 1.0, hint=f"factor on joints.{entry}")
            for entry in entries
        }
        button = gui.add_button("As described")
    for slider in sliders.values():
        slider.on_update(lambda _: changed())

    def back(_: object) -> None:
        for slider in sliders.values():
            _set(slider, 1.0)
        changed()

    button.on_click(back)
    return sliders


def _pose_slider(gui: viser.GuiApi, machine: Machine, name: str, low: float, high: float, start: float) -> PoseSlider:
    dimension = machine.kinematics.task.coordinates[name]
    factor = dimension.factor(UNITS)
    low, high, start = (_shown(value, factor) for value in (low, high, start))
    step = 10.0 ** floor(log10((high - low) / _STEPS))
    return PoseSlider(gui.add_slider(f"{name} [{dimension.label(UNITS)}]", low, high, step, start), factor)


def _set(slider: Any, value: float) -> None:
    """viser's types call the value of a slider read-only, which it is not."""
    slider.value = value


def _shown(value: float, factor: float) -> float:
    """Without the rounding of the last digits that 0.09 m would show as 90.00000000000001 mm."""
    return round(value / factor, 9)
