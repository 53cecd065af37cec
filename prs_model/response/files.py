"""Frequency responses as files: CSV, universal file, picture; complete, or not at all."""

from __future__ import annotations

import csv
import io
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..errors import PrsError, short
from ..modes.figure_file import check_writable, told
from ..reduction.storage import whole
from .quantity import DIRECTIONS, listed_pairs, unit

if TYPE_CHECKING:
    from .frequency_response import FrequencyResponse

PICTURES = (".png", ".svg", ".pdf")
SUFFIXES = (".csv", ".uff", *PICTURES)


def check_file(path: Path) -> None:
    """Raise PrsError or MissingExtraError now if a response could not be written to `path` later."""
    suffix = path.suffix.lower()
    if suffix not in SUFFIXES:
        raise PrsError(f"{short(path)}: found a name ending in '{suffix}', expected one of {', '.join(SUFFIXES)}")
    if suffix == ".uff":
        from .universal_file import pyuff

        pyuff()
    if suffix in PICTURES:
        from ..modes.figure_file import matplotlib_figure

        matplotlib_figure("drawing a frequency response")
    check_writable(path)


def save(response: FrequencyResponse, path: Path, pairs: str | Sequence[str] | None = None, title: str = "") -> None:
    """See FrequencyResponse.save."""
    listed = listed_pairs(pairs)
    check_file(path)
    if path.suffix.lower() in PICTURES:
        from .picture import draw

        draw({"": response}, path, DIRECTIONS if pairs is None else ["/".join(pair) for pair in listed], title)
        return
    from .universal_file import write_uff

    write = write_csv if path.suffix.lower() == ".csv" else write_uff
    with told(path):
        write(response, path, listed)


def write_csv(response: FrequencyResponse, path: Path, pairs: Sequence[tuple[str, str]]) -> None:
    """A line each frequency, real and imaginary part of each pair; units in the header."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = ["/".join(pair) for pair in pairs]
    units = [unit(*pair, response.quantity) for pair in pairs]
    columns = [f"{part} {name} [{units[k]}]" for k, name in enumerate(names) for part in ("re", "im")]
    writer.writerow(["frequency [Hz]", *columns])
    curves = np.array([response.curve(name) for name in names])
    for k, frequency in enumerate(response.frequencies):
        row = np.column_stack([curves[:, k].real, curves[:, k].imag]).ravel()
        writer.writerow([repr(float(frequency)), *(f"{value:.12e}" for value in row)])
    with whole(path) as file:
        file.write(text.getvalue().encode())
