"""Plug-ins found through entry points: reducers, machines and tasks. Found once, loaded when asked for."""

from __future__ import annotations

import logging
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Generic, Literal, TypeVar, get_args

from .description.problems import closest
from .description.schema import Body, Section
from .description.units import Units
from .errors import PartFileError, PluginError, PrsError, UnknownNameError, short

if TYPE_CHECKING:
    from .finite_elements import FiniteElementModel
    from .kinematics.tasks import Task
    from .reduction import SuperElement

REDUCERS, MACHINES, TASKS = "prs_model.reducers", "prs_model.machines", "prs_model.tasks"
_WHAT = {REDUCERS: "reducer", MACHINES: "machine", TASKS: "task"}
_log = logging.getLogger(__name__)
T = TypeVar("T")
OptionsT = TypeVar("OptionsT", bound=Section)

Gives = Literal["full", "reduced", "either"]
FileUnits = Literal["asked", "optional", "SI"]
LITERALS = {"gives": get_args(Gives), "units": get_args(FileUnits)}
TAKEN = frozenset(
    {"reducer", "source", "interfaces", "units", "modes", "coupling", "grounded", "clamped", "expected", "options"}
)  # arguments of `reduce`, which no option can have as its name

NO_UNITS = "the file does not say its units: add 'units', such as mm-N-tonne-s or m-N-kg-s"


@dataclass(frozen=True)
class PartRequest(Generic[OptionsT]):
    """What a reducer is asked to read: one part, its file, its validated options (SI) and the file's units.

    body: the entry of the machine, or what `reduce` was given; None where there is none.
    """

    name: str
    source: Path | None
    options: OptionsT
    units: Units | None
    body: Body | None = None

    @property
    def path(self) -> Path:
        """The part file. Raises PartFileError when none was named."""
        if self.source is None:
            raise PartFileError(self.name, "no 'source' given, expected a part file")
        return self.source

    @property
    def file_units(self) -> Units:
        """The units the file is written in. Raises PartFileError when nobody said them."""
        if self.units is None:
            raise PartFileError(self.source or self.name, NO_UNITS)
        return self.units


class Reducer(ABC, Generic[OptionsT]):
    """Reads one kind of part. Full matrices come back as a FiniteElementModel, reduced ones as a SuperElement.

    description: one line. Options: a Section, validated like the rest of machine.yaml. needs_source: reads a file.
    gives: full matrices, which are reduced here, or reduced ones, or either, as the file has it. units: "asked" where
    the file does not say its units, "optional" where it may, "SI" where it has no others. writes: suffixes of the files
    that `write` makes. version: raised when what is read of the same file changes, so that stored parts are made again.
    """

    description: ClassVar[str]
    Options: ClassVar[type[Section]]
    needs_source: ClassVar[bool] = True
    gives: ClassVar[Gives] = "either"
    units: ClassVar[FileUnits] = "asked"
    writes: ClassVar[tuple[str, ...]] = ()
    version: ClassVar[int] = 1

    @abstractmethod
    def read(self, part: PartRequest[OptionsT]) -> FiniteElementModel | SuperElement:
        """Read the part in SI units, in its body frame. Raises PartFileError naming the file and what is wrong."""

    def files(self, part: PartRequest[OptionsT]) -> tuple[Path, ...]:
        """Every file that `read` reads, the source first: a change in one of them makes the part again."""
        return (part.path,)

    def write(self, element: SuperElement, path: Path, units: Units) -> None:
        """Write an element in `units`, for suffixes in `writes`. Raises PartFileError when it cannot be written so."""
        raise NotImplementedError


def reducer(name: str) -> Reducer[Any]:
    """The reducer plug-in of that name. Raises UnknownNameError or PluginError."""
    return _use(REDUCERS, name, _reducer)


@contextmanager
def reading(name: str, part: PartRequest[Any]) -> Iterator[None]:
    """Where a reducer reads `part`: what its code raises that is no PrsError becomes a PluginError naming the file."""
    try:
        yield
    except (PrsError, MemoryError):
        raise
    except Exception as error:
        raise _failed(name, part, f"{type(error).__name__}: {error}") from error


def read(name: str, part: PartRequest[Any]) -> FiniteElementModel | SuperElement:
    """What a reducer reads. Raises PluginError where its code fails, or gives something else than it says it does."""
    from .finite_elements import FiniteElementModel
    from .reduction import SuperElement

    plugin = reducer(name)
    with reading(name, part):
        given = plugin.read(part)
    kinds = {"full": (FiniteElementModel,), "reduced": (SuperElement,), "either": (FiniteElementModel, SuperElement)}
    expected = kinds[plugin.gives]
    if not isinstance(given, expected):
        wanted = " or a ".join(kind.__name__ for kind in expected)
        raise _failed(name, part, f"it gave {short(repr(given))}, expected a {wanted}")
    return given


def _failed(name: str, part: PartRequest[Any], cause: str) -> PluginError:
    point = _found(REDUCERS)[name]
    outcome = f"failed on {part.source or part.name}"
    return PluginError(_WHAT[REDUCERS], name, _origin(point), f"{cause}; report it to its author", outcome)


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


def _reducer(point: EntryPoint) -> Reducer[Any]:
    plugin: type[Reducer[Any]] = _class(point, Reducer, {"description": str, "Options": type})
    for name, choices in LITERALS.items():
        if (found := getattr(plugin, name)) not in choices:
            raise _UnfitError(f"found {name} = {found!r} in {plugin.__name__}, expected one of {', '.join(choices)}")
    if not issubclass(plugin.Options, Section):
        raise _UnfitError(f"found Options that are no subclass of prs_model.Section in {plugin.__name__}")
    if taken := sorted(TAKEN & plugin.Options.model_fields.keys()):
        raise _UnfitError(f"found an option '{taken[0]}', which is an argument of prs_model.reduce: rename it")
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
