"""Pictures and numbers as text within the page."""

from __future__ import annotations

import base64
import io
import re
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

_SHADES = 256  # of a picture
_DIGITS = re.compile(rb"(?<![\d.])([1-9]\d*\.\d\d)\d+")  # coordinates; scales are below 1


def embedded(path: Path) -> str:
    """A picture as a URL that holds it, with fewer digits or shades than its file has."""
    if path.suffix == ".svg":
        shorter = _DIGITS.sub(rb"\1", path.read_bytes())
        return f"data:image/svg+xml;base64,{_base64(shorter)}"
    return f"data:image/png;base64,{_base64(_lightened(path))}"


def numbers_text(array: NDArray[Any]) -> str:
    """The bytes of an array as base64."""
    return _base64(np.ascontiguousarray(array).tobytes())


def _lightened(path: Path) -> bytes:
    from PIL import Image

    with Image.open(path) as picture:
        shades = picture.convert("RGB").quantize(_SHADES, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    file = io.BytesIO()
    shades.save(file, "PNG", optimize=True)
    return file.getvalue()


def _base64(content: bytes) -> str:
    return base64.b64encode(content).decode()
