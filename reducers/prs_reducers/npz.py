"""Super-elements stored by this program."""

from __future__ import annotations

from typing import ClassVar

from prs_model.description.schema import Section
from prs_model.errors import PartFileError
from prs_model.plugins import PartRequest, Reducer
from prs_model.reduction import SuperElement


class NpzOptions(Section):
    """No options."""


class NpzReducer(Reducer):
    description: ClassVar[str] = "super-element stored by this program (.npz, SI)"
    Options: ClassVar[type[Section]] = NpzOptions

    def read(self, part: PartRequest) -> SuperElement:
        """Read the file. Raises PartFileError when it is missing, damaged, or asked to be in other units than SI."""
        if part.source is None:
            raise PartFileError(part.name, "no 'source' given, expected an .npz file")
        if part.units is not None:
            raise PartFileError(part.source, "stored super-elements are in SI: leave 'units' out")
        return SuperElement.load(part.source)
