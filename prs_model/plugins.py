"""Plug-ins found through entry points: reducers, machines and tasks. Found once, loaded when asked for."""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, TypeVar

from .description.problems import closest
from .description.schema import Body, Section
from .description.units import Units
from .errors import PluginError, UnknownNameError, short

if TYPE_CHECKING:
    from .finite_elements import FiniteElementModel
    from .kinematics.tasks import Task
    from .reduction import SuperElement

REDUCERS, MACHINES, TASKS = "prs_model.reducers", "prs_model.machines", "prs_model.tasks"
_WHAT = {REDUCERS: "reducer", MACHINES: "machine", TASKS: "task"}
_log = logging.getLogger(__name__)
T = TypeVar("T")


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
    version: ClassVar[int] = 1  # raised when what it reads of the same file changes: stored parts are made again

    @abstractmethod
    def read(self, part: PartRequest) -> FiniteElementModel | SuperElement:
        """Read the part in SI units, in its body frame. Raises PartFileError naming the file and what is wrong."""


def reducer(name: str) -> Reducer:
    """The reducer plug-in of that name. Raises UnknownNameError or PluginError."""
    return _use(REDUCERS, name, _reducer)


def task(name: str) -> type[Task]:
    """The task plug-in class of that name. Raises UnknownNameError or PluginError."""
    return _use(TASKS, name, _task)


def machine_folder(name: str) -> Path:
    """The folder of a machine that is installed under that name. Raises UnknownNameError or PluginError."""
    return _use(MACHINES, name, _package_folder)


def names(group: str) -> tuple[str, ...]:
    """Names of the installed plug-ins of a group, whether they can be used or not."""
    return tuple(_found(group))


def list_machines() -> tuple[str, ...]:
    """Names of the installed machines."""
    return names(MACHINES)


def list_reducers() -> dict[str, str]:
    """Installed reducers with their one-line descriptions. One that cannot be used is left out with a warning."""
    described = {}
    for name in names(REDUCERS):
        try:
            described[name] = reducer(name).description
        except PluginError as error:
            _log.warning("%s", error)
    return described


def unknown(what: str, name: str, known: list[str]) -> UnknownNameError:
    """The error for a name that is not among `known`, with a did-you-mean."""
    close = closest(name, known)
    return UnknownNameError(what, name, known, f"Did you mean '{close}'?" if close else "")


@cache
def _found(group: str) -> dict[str, EntryPoint]:
    """The entry points of a group by name; of several with one name the first on Python's path counts."""
    found: dict[str, EntryPoint] = {}
    for point in entry_points(group=group):
        first = found.setdefault(point.name, point)
        if first.value != point.value:
            what = f"{_WHAT[group]} '{point.name}'"
            _log.warning("%s is installed twice: %s is used, %s is not", what, _origin(first), _origin(point))
    return dict(sorted(found.items()))


def _origin(point: EntryPoint) -> str:
    return f"{point.value} of {point.dist.name}" if point.dist else point.value


def _use(group: str, name: str, make: Callable[[EntryPoint], T]) -> T:
    """What `make` makes of an entry point. Whatever a plug-in raises becomes a PluginError."""
    points = _found(group)
    if name not in points:
        raise unknown(_WHAT[group], name, list(points))
    try:
        return make(points[name])
    except Exception as error:
        cause = str(error) if isinstance(error, _UnfitError) else f"{type(error).__name__}: {error}"
        raise PluginError(_WHAT[group], name, points[name].value, cause) from error


class _UnfitError(Exception):
    """A plug-in that loads but is not what its group asks for."""


def _reducer(point: EntryPoint) -> Reducer:
    plugin: type[Reducer] = _class(point, Reducer, {"description": str, "Options": type})
    return plugin()


def _task(point: EntryPoint) -> type[Task]:
    from .kinematics.tasks import Task

    plugin: type[Task] = _class(point, Task, {"coordinates": Mapping, "Options": type})
    return plugin


def _class(point: EntryPoint, base: type, attributes: Mapping[str, type]) -> Any:
    found = point.load()
    if not (isinstance(found, type) and issubclass(found, base)):
        raise _UnfitError(f"found {short(repr(found))}, expected a subclass of prs_model.{base.__name__}")
    for name, kind in attributes.items():
        if not isinstance(getattr(found, name, None), kind):
            raise _UnfitError(f"found no '{name}' in {found.__name__}, expected one as in prs_model.{base.__name__}")
    return found


def _package_folder(point: EntryPoint) -> Path:
    spec = find_spec(point.value)
    if spec is None:
        raise _UnfitError("found no such package")
    if not spec.submodule_search_locations:
        raise _UnfitError("found a module, expected a package: a folder with machine.yaml in it")
    return Path(spec.submodule_search_locations[0])
