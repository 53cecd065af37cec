"""From a body of the description, or the arguments of `reduce`, to a super-element: found, or made and stored."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from .. import plugins
from ..description.interface import Coupling, NodeId
from ..description.schema import Body, ReductionDefaults
from ..errors import PartFileError, PrsError
from ..finite_elements import FiniteElementModel
from .expected import check_expected
from .made import make_part
from .recipe import Settings, recipe
from .request import all_interfaces, all_options, asked, body_of
from .store import Element, StoredPart, files_hash
from .summary import echo
from .super_element import SuperElement
from .travelling import TravellingElement

MOST_KEPT = 64
_made: dict[tuple[object, ...], Element] = {}  # the latest elements of this process, oldest first


def build_part(
    name: str,
    body: Body,
    defaults: ReductionDefaults,
    folder: Path,
    *,
    stem: str | None = None,
) -> SuperElement | TravellingElement:
    """The super-element of a body: from the store when it is there and up to date, else read, reduced and stored.

    name: the body's, for messages; stem: the entry it was expanded from (``rod`` of ``rod_2``), under which it is
    stored once for all; folder: the machine's, to which `source` and the store are relative.
    Raises UnknownNameError, DescriptionError, PluginError, PartFileError or PhysicsError.
    """
    element = _remembered(_wanted(stem or name, body, defaults, folder))
    if body.expected is not None:
        check_expected(element, body.expected)
    return _travelling_with(element, body)


def reduce(
    reducer: str,
    source: str | Path | None = None,
    *,
    nodes: Mapping[str, Any] | Sequence[NodeId] | None = None,
    interfaces: Mapping[str, Any] | Sequence[NodeId] | None = None,
    units: str | None = None,
    modes: int | None = None,
    coupling: Coupling = "rigid",
    grounded: bool = False,
    clamped: str | Iterable[str] = (),
    expected: Mapping[str, float] | None = None,
    options: Mapping[str, Any] | None = None,
    **more: Any,
) -> SuperElement:
    """Read one part with any reducer plug-in and reduce it, outside of a machine.

    interfaces: by name, as in machine.yaml, or in short: a word is a node set or else the node of that name, a number a
    node, a list several nodes, such as ``{"tip": "TIP", "root": [11, 19]}``; a list of names stands for interfaces that
    are called so. nodes: the same for nodes only (a reducer with an option of that name gets it instead).
    units: of the part file, such as ``mm-N-tonne-s``; modes: how many to keep of a part that is reduced here (default
    3); grounded: held to the ground in its file; clamped: node sets that are held here; expected: `mass` [kg] and
    `frequency` [Hz] that are known; options: of the reducer, as a mapping or by name (`**more`). Everything given here
    (options, places of interfaces) is in SI. The same call for the same file gives the same element again, without
    reading it.
    Raises UnknownNameError, DescriptionError, PluginError, PartFileError, PhysicsError.
    """
    options = all_options(reducer, options, more)
    if nodes is not None and "nodes" in plugins.reducer(reducer).Options.model_fields:
        nodes, options = None, all_options(reducer, options, {"nodes": nodes})
    sets = (clamped,) if isinstance(clamped, str) else tuple(clamped)
    body = body_of(
        reducer,
        source,
        units,
        options=options,
        interfaces=all_interfaces(nodes, interfaces),
        clamped=sets,
        grounded=grounded or bool(sets),
        expected=expected,
        modes=modes,
        coupling=coupling,
        method="craig-bampton",
    )
    element = build_part(body.frame, body, ReductionDefaults(), Path())
    if isinstance(element, TravellingElement):
        travels = f"interface of {body.frame} travels with joint {element.joint}"
        raise PrsError(f"reduce: {travels}; describe a machine for that")
    return element


def read_part(
    reducer: str,
    source: str | Path | None = None,
    *,
    units: str | None = None,
    options: Mapping[str, Any] | None = None,
    **more: Any,
) -> FiniteElementModel | SuperElement:
    """What a reducer reads of a part, in SI, before interfaces, reduction and the physics gate.

    units: of the part file; options: of the reducer, in SI, as a mapping or by name (`**more`).
    Raises UnknownNameError, DescriptionError, PluginError, PartFileError.
    """
    body = body_of(reducer, source, units, options=all_options(reducer, options, more))
    return plugins.read(reducer, asked(body.frame, body, Path())[1])


@dataclass(frozen=True, eq=False)
class _Wanted:
    """One part with everything that decides what it becomes. files: read from, source first; none of some reducers."""

    request: plugins.PartRequest[Any]
    body: Body
    settings: Settings
    recipe: str
    files: tuple[Path, ...]
    store: StoredPart | None

    def key(self) -> tuple[object, ...]:
        """Changes when the recipe, one of the files or what is stored does."""
        stored = () if self.store is None else (self.store.path,)
        return self.request.name, self.recipe, *((path.resolve(), _stamp(path)) for path in (*self.files, *stored))


def _wanted(stem: str, body: Body, defaults: ReductionDefaults, folder: Path) -> _Wanted:
    reducer, request = asked(stem, body, folder)
    settings = Settings.of(body, defaults)
    text = recipe(body, request.options, settings, reducer.version)
    if request.source is None:
        return _Wanted(request, body, settings, text, (), None)
    with plugins.reading(body.reducer, request):
        files = tuple(reducer.files(request))
    store = None if defaults.store is None else StoredPart(folder / defaults.store, stem, text, files)
    return _Wanted(request, body, settings, text, files, store)


def _stamp(path: Path) -> tuple[int, int] | None:
    """What changes when a file does; None when there is none."""
    try:
        status = path.stat()
    except OSError:
        return None
    return status.st_mtime_ns, status.st_size


def _remembered(wanted: _Wanted) -> Element:
    """The element of a part, kept for as long as its files, its recipe and the store stay as they are."""
    element = _made.get(wanted.key())
    if element is None:
        element = _found_or_made(wanted)
        _made[wanted.key()] = element
        if len(_made) > MOST_KEPT:
            del _made[next(iter(_made))]
    return element


def _found_or_made(wanted: _Wanted) -> Element:
    stored = wanted.store.find() if wanted.store is not None else None
    if stored is not None:
        stored.check()
        return stored
    made_from = {"recipe": wanted.recipe}
    if wanted.files:
        if not wanted.files[0].exists():
            raise PartFileError(wanted.files[0], "there is no such file; correct 'source'")
        made_from |= {"source": str(wanted.body.source), "source_sha256": files_hash(wanted.files)}
    made = make_part(wanted.request, wanted.body, wanted.settings, made_from)
    echo(made.element, wanted.request.name)
    if wanted.store is not None and made.reduced_here:
        wanted.store.keep(made.element)
    return made.element


def _travelling_with(element: Element, body: Body) -> Element:
    """A travelling part of another limb travels with that limb's joint."""
    joints = [each.travel.joint for each in body.interfaces.values() if each.travel is not None]
    if isinstance(element, TravellingElement) and joints and joints[0] != element.joint:
        return replace(element, joint=joints[0])
    return element
