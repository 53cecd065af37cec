"""Super-elements stored by this program."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

from prs_model.description.schema import Section
from prs_model.description.units import Units
from prs_model.plugins import PartRequest, Reducer
from prs_model.reduction import SuperElement


class NpzOptions(Section):
    """No options."""


class NpzReducer(Reducer[NpzOptions]):
    description: ClassVar[str] = "super-element stored by this program (.npz, SI)"
    Options: ClassVar[type[Section]] = NpzOptions
    gives = "reduced"
    units = "SI"
    writes = (".npz",)

    def read(self, part: PartRequest[NpzOptions]) -> SuperElement:
        """Read the file. Raises PartFileError when it is missing or damaged."""
        return SuperElement.load(part.path)

    def write(self, element: SuperElement, path: Path, units: Units) -> None:
        """Write the element; such files are always in SI."""
        element.save(path)
