"""Which files a part is read from."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from .. import plugins
from ..description.units import SI, Units
from .request import validated


def read_files(
    reducer: str, source: str | Path | None, *, units: str | None = None, options: Mapping[str, Any]
) -> tuple[Path, ...]:
    """The files that the reducer reads of a part and that are there, the source first; none for one that reads none.

    Raises UnknownNameError, DescriptionError, PartFileError, and ValueError for units that are none.
    """
    plugin = plugins.reducer(reducer)
    if source is None or not plugin.needs_source:
        return ()
    path = Path(source)
    valid = validated(plugin.Options, options, reducer, (), SI)
    request = plugins.PartRequest(path.stem, path, valid, None if units is None else Units.parse(units))
    return tuple(dict.fromkeys(file for file in plugin.files(request) if file.is_file()))
