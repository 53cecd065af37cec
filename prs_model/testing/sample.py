"""One part whose figures are known, to try a reducer with."""

from __future__ import annotations

import os
import shutil
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from .. import plugins
from ..arrays import FloatArray
from ..finite_elements import FiniteElementModel
from ..reduction import SuperElement, read_part, reduce
from ..reduction.read_files import read_files
from ..reduction.summary import summarize


@dataclass(frozen=True)
class Sample:
    """A part file, how it is read, and what must come out.

    reducer, source, units, options, interfaces, grounded, clamped, modes: as for `prs_model.reduce`. mass [kg]: of
    the part as read. free, fixed: first frequencies [Hz], without the zeros of rigid motion; free ones of the part as
    read (of a grounded one: as it is held), fixed ones with all interfaces held. accuracy: relative, of these figures.
    others: files of another part by the name of the companion they could be mistaken for. unseen: what damage nothing
    can notice and why, by a pattern such as ``part.txt: another digit*`` for a line of the damage table.
    """

    reducer: str
    source: str | Path | None = None
    units: str | None = None
    options: Mapping[str, Any] = field(default_factory=dict)
    interfaces: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    grounded: bool = False
    clamped: tuple[str, ...] = ()
    modes: int | None = None
    mass: float | None = None
    free: tuple[float, ...] = ()
    fixed: tuple[float, ...] = ()
    accuracy: float = 1e-6
    others: Mapping[str, str | Path] = field(default_factory=dict)
    unseen: Mapping[str, str] = field(default_factory=dict)

    @property
    def path(self) -> Path:
        """The part file. Raises ValueError for a sample without one."""
        if self.source is None:
            raise ValueError(f"{self.reducer}: a sample without a source has no file")
        return Path(self.source)

    @property
    def plugin(self) -> plugins.Reducer[Any]:
        """The reducer. Raises UnknownNameError or PluginError."""
        return plugins.reducer(self.reducer)

    def read(self) -> FiniteElementModel | SuperElement:
        """What the reducer gives, before reduction and the physics gate."""
        return read_part(self.reducer, self.source, units=self.units, options=self.options)

    def reduce(self) -> SuperElement:
        """The super-element at the sample's interfaces, past the physics gate."""
        return reduce(
            self.reducer,
            self.source,
            interfaces=self.interfaces,
            units=self.units,
            modes=self.modes,
            grounded=self.grounded,
            clamped=self.clamped,
            options=self.options,
        )

    def files(self) -> tuple[Path, ...]:
        """What the reducer says it reads and is there, the source first."""
        return read_files(self.reducer, self.path, units=self.units, options=self.options)

    def copied(self, folder: Path) -> Sample:
        """The sample with its files, and nothing else, copied to a folder; they lie to each other as they did."""
        files = self.files()
        root = Path(os.path.commonpath([file.resolve().parent for file in files]))
        for file in files:
            target = folder / file.resolve().relative_to(root)
            target.parent.mkdir(parents=True, exist_ok=True)
            shutil.copyfile(file, target)
        return replace(self, source=folder / self.path.resolve().relative_to(root))


@dataclass(frozen=True, eq=False)
class Figures:
    """Of a part as read: mass [kg], None when it is held; size (3,) [m] around its nodes; elastic frequencies [Hz]."""

    mass: float | None
    size: FloatArray
    free: FloatArray


def figures(sample: Sample, count: int = 1) -> Figures:
    """The figures of the sample's part as its reducer reads it, with `count` elastic frequencies."""
    part, held = sample.read(), sample.grounded and not sample.clamped
    mass = None if held else part.mass_properties().mass
    if isinstance(part, SuperElement):
        part = replace(part, grounded=part.grounded or held)
        return Figures(mass, np.ptp(part.positions, axis=0), summarize(part, count).free)
    wanted = count if held else count + 6
    return Figures(mass, np.ptp(part.coordinates, axis=0), part.frequencies(min(wanted, part.size))[wanted - count :])
