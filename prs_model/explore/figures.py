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

_COLOURS = {"u": "#0072b2", "v": "#d55e00", "w": "#009e73"}  # told apart by the colour-blind too
_DASHES: dict[str, list[int]] = {"u": [], "v": [8, 4], "w": [2, 3]}
_TEXT = "margin: 0 0.8em 0.6em; font-size: 0.85em; line-height: 1.4"


def paragraph(lines: Sequence[str], role: str = "status") -> str:
    """Lines of plain text as HTML, the first one bold; screen readers read it when it changes."""
    first, *others = map(escape, lines)
    return f'<p role="{role}" style="{_TEXT}">{"<br>".join([f"<b>{first}</b>", *others])}</p>'


def frequency_table(found: Modes, start: Modes) -> str:
    """Frequencies as HTML, how far they are from those at the start, and what moves."""
    rows = [
        f'<tr><td>{k + 1}</td><td class="frequency">{frequency:.3f}</td><td>{_change(start, k, frequency)}</td>'
        f'<td style="text-align: left">{escape(f"{character.group} {character.motion}")}</td></tr>'
        for k, (frequency, character) in enumerate(zip(found.frequencies, found.characters(), strict=True))
    ]
    head = "".join(f"<th>{word}</th>" for word in ("mode", "Hz", "change"))
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


def _change(start: Modes, k: int, frequency: float) -> str:
    """Against the mode of the same number at the start."""
    if k >= len(start.frequencies) or start.frequencies[k] == 0.0:
        return ""
    return f"{100.0 * (frequency / start.frequencies[k] - 1.0):+.1f} %"
