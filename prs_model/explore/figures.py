"""What the page says in words, tables and curves."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import FloatArray

if TYPE_CHECKING:
    import viser

    from ..modes import Modes
    from ..response import FrequencyResponse
    from .following import Origin

_COLOURS = {"u": "#0072b2", "v": "#d55e00", "w": "#009e73"}  # told apart by the colour-blind too
_DASHES: dict[str, list[int]] = {"u": [], "v": [8, 4], "w": [2, 3]}
_TEXT = "margin: 0 0.8em 0.6em; font-size: 0.85em; line-height: 1.4"


def paragraph(lines: Sequence[str], role: str = "status") -> str:
    """Lines of plain text as HTML, the first one bold; screen readers read it when it changes."""
    first, *others = map(escape, lines)
    return f'<p role="{role}" style="{_TEXT}">{"<br>".join([f"<b>{first}</b>", *others])}</p>'


def frequency_table(found: Modes, origins: Sequence[Origin | None]) -> str:
    """Frequencies as HTML, which mode of the start each one was, how far it is from that, and what moves."""
    rows = [
        f'<tr><td>{k}</td><td class="frequency">{frequency:.3f}</td>{_change(origin)}'
        f'<td style="text-align: left">{escape(f"{character.group} {character.motion}")}</td></tr>'
        for k, (frequency, origin, character) in enumerate(
            zip(found.frequencies, origins, found.characters(), strict=True), start=1
        )
    ]
    head = "".join(f"<th>{word}</th>" for word in ("mode", "Hz", "change", "was"))
    return (
        f'<table aria-label="natural frequencies" style="{_TEXT}; text-align: right; border-spacing: 0.5em 0">'
        f'<tr>{head}<th style="text-align: left">what moves</th></tr>{"".join(rows)}</table>'
    )


def add_plot(gui: viser.GuiApi, response: FrequencyResponse, note: str) -> viser.GuiUplotHandle:
    """Magnitude of the receptance along u, v, w over frequency."""
    lines: list[Any] = [{"label": "Hz"}]
    lines += [
        {"label": axis, "stroke": colour, "width": 1.5, "dash": _DASHES[axis]} for axis, colour in _COLOURS.items()
    ]
    return gui.add_uplot(
        curves(response),
        series=tuple(lines),
        title=f"Receptance, {note}",
        scales={"x": {"time": False}, "y": {"distr": 3}},
        axes=({"label": "frequency [Hz]", "space": 30}, {"label": "µm/N", "size": 60}),
        padding=(16, 8, 0, 0),
        height=300,
    )


def curves(response: FrequencyResponse) -> tuple[FloatArray, ...]:
    """Frequencies (f,) [Hz], then magnitudes (f,) [µm/N] along u, v, w."""
    return response.frequencies, *(1e6 * np.abs(response.curve(axis)) for axis in _COLOURS)


def _change(origin: Origin | None) -> str:
    """Two cells: the change of the frequency, and the mode of the start that has this shape."""
    if origin is None:
        return "<td></td><td>new</td>"
    change = "" if origin.change is None else f"{round(100.0 * origin.change, 1) + 0.0:+.1f} %"
    return f"<td>{change}</td><td>{origin.number}</td>"
