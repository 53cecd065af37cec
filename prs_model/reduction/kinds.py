"""Which bodies are one part: one entry gives several, unless one limb's is changed."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from ..description.schema import Body
from .recipe import Settings, recipe
from .request import asked


class Kind(NamedTuple):
    """What decides a part: the entry that its body was expanded from, and its recipe."""

    stem: str
    recipe: str


def kind_of(stem: str, body: Body, folder: Path, settings: Settings) -> Kind:
    """The kind of a body: equal for bodies that are one part. Raises what asking for the part raises."""
    reducer, request = asked(stem, body, folder)
    return Kind(stem, recipe(body, request.options, settings, reducer.version))
