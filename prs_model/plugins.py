"""Plug-ins found through entry points: reducers, machines and tasks. Found once, loaded when asked for."""

from __future__ import annotations

import warnings
from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from difflib import get_close_matches
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from .description.schema import Body, Section
from .description.units import Units
from .errors import UnknownNameError

if TYPE_CHECKING:
    from .finite_elements import FiniteElementModel
    from .reduction import SuperElement

REDUCERS, MACHINES, TASKS = "prs_model.reducers", "prs_model.machines", "prs_model.tasks"


@dataclass(frozen=True)
class PartRequest:
    """What a reducer is asked to read: one part, its file, its validated options (SI) and the file's units."""

    name: str
    source: Path | None
    options: Section
    units: Units | None
    body: Body | None = None


class Reducer(ABC):
    """Reads one kind of part. Full matrices come back as a FiniteElementModel, reduced ones as a SuperElement."""

    description: ClassVar[str]
    Options: ClassVar[type[Section]]
    needs_source: ClassVar[bool] = True

    @abstractmethod
    def read(self, part: PartRequest) -> FiniteElementModel | SuperElement:
        """Read the part in SI units, in its body frame. Raises PartFileError naming the file and what is wrong."""


@cache
def _found(group: str) -> dict[str, EntryPoint]:
    return {point.name: point for point in sorted(entry_points(group=group), key=lambda p: p.name)}


def _load(group: str, what: str, name: str) -> Any:
    points = _found(group)
    if name not in points:
        raise unknown(what, name, list(points))
    try:
        return points[name].load()
    except Exception as error:
        raise UnknownNameError(
            what, name, list(points), f"'{name}' is registered as {points[name].value} but does not load: {error}"
        ) from error


def unknown(what: str, name: str, known: list[str]) -> UnknownNameError:
    """The error for a name that is not among `known`, with a did-you-mean."""
    close = get_close_matches(name, known, n=1)
    return UnknownNameError(what, name, known, f"Did you mean '{close[0]}'?" if close else "")


def reducer(name: str) -> Reducer:
    """The reducer plug-in of that name."""
    return _instance(_load(REDUCERS, "reducer", name))


def _instance(plugin: Callable[[], Reducer]) -> Reducer:
    return plugin()


def task(name: str) -> Any:
    """The task plug-in class of that name."""
    return _load(TASKS, "task", name)


def machine_folder(name: str) -> Path:
    """The folder of a machine that is installed under that name."""
    package = _load(MACHINES, "machine", name)
    return Path(str(files(package)))


def list_machines() -> tuple[str, ...]:
    """Names of the installed machines."""
    return tuple(_found(MACHINES))


def list_reducers() -> dict[str, str]:
    """Installed reducers with their one-line descriptions. One that does not load is left out with a warning."""
    described = {}
    for name in _found(REDUCERS):
        try:
            described[name] = reducer(name).description
        except UnknownNameError as error:
            warnings.warn(str(error), stacklevel=2)
    return described
