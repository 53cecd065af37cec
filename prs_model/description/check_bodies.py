"""Bodies: their link, their reducer and its options, and where they are held."""

from __future__ import annotations

from typing import Any

from pydantic import ValidationError

from .. import plugins
from ..errors import PluginError, UnknownNameError
from .messages import report
from .problems import Place, not_known
from .schema import Body, Section
from .subject import Subject
from .units import Units


def check_bodies(subject: Subject) -> None:
    """Check every body of the machine."""
    for name, body in subject.file.bodies.items():
        _check_reducer(subject, ("bodies", name), body)
    for place, _, body in subject.each_body():
        subject.check_link((*place, "frame"), body.frame)
        _check_ground(subject, place, body)


def options_in_si(body: Body, units: Units) -> dict[str, Any]:
    """The reducer's options, validated and in SI, as its Options class takes them back. Raises ValidationError."""
    options = _options_class(body.reducer).model_validate(body.options, context={"units": units})
    return options.model_dump(exclude_unset=True, by_alias=True)


def _options_class(reducer: str) -> type[Section]:
    return plugins.reducer(reducer).Options


def interface_place(subject: Subject, place: Place, instance: Body, name: str) -> Place:
    """Where an instance's interface stands in the file; its name there may hold a placeholder."""
    entry = subject.file.bodies[str(place[1])]
    return (*place, "interfaces", dict(zip(instance.interfaces, entry.interfaces, strict=True))[name])


def _check_reducer(subject: Subject, place: Place, body: Body) -> None:
    try:
        plugin = plugins.reducer(body.reducer)
    except UnknownNameError as error:
        subject.problems.add((*place, "reducer"), not_known("a reducer", body.reducer, error.known))
        return
    except PluginError as error:
        subject.problems.add((*place, "reducer"), str(error))
        return
    _check_source(subject, place, body, plugin.needs_source)
    _check_units(subject, place, body, plugin)
    if plugin.gives == "reduced" and body.modes is not None:
        message = f"found modes, expected none; what reducer '{body.reducer}' gives is reduced already: remove it"
        subject.problems.add((*place, "modes"), message)
    try:
        options_in_si(body, subject.file.units)
    except ValidationError as error:
        report(error, plugin.Options, body.options, subject.problems, (*place, "options"))


def _may_be_stored(subject: Subject) -> bool:
    return subject.file.reduction.store is not None or subject.problems.touches(("reduction",))


def _check_source(subject: Subject, place: Place, body: Body, needed: bool) -> None:
    if body.source is None:
        if needed:
            message = f"found nothing, expected the part's file; reducer '{body.reducer}' reads one: add 'source'"
            subject.problems.add((*place, "source"), message)
        return
    if not needed:
        message = f"found '{body.source}', expected nothing; reducer '{body.reducer}' reads no file: remove 'source'"
        subject.problems.add((*place, "source"), message)
    elif "<" not in body.source and not _may_be_stored(subject) and not (subject.folder / body.source).is_file():
        message = f"found '{body.source}', expected a file in {subject.folder}; make it, or correct the name"
        subject.problems.add((*place, "source"), message)


def _check_units(subject: Subject, place: Place, body: Body, plugin: plugins.Reducer[Any]) -> None:
    if body.units is None:
        if plugin.needs_source and plugin.units == "asked":
            subject.problems.add((*place, "units"), f"found nothing; {plugins.NO_UNITS}")
    elif not plugin.needs_source:
        message = f"found units, expected none; they are of part files, and reducer '{body.reducer}' reads none"
        subject.problems.add((*place, "units"), message)
    elif plugin.units == "SI":
        message = f"found units, expected none; files for reducer '{body.reducer}' are in SI: remove 'units'"
        subject.problems.add((*place, "units"), message)
    else:
        try:
            Units.parse(body.units)
        except ValueError as error:
            subject.problems.add((*place, "units"), str(error))


def _check_ground(subject: Subject, place: Place, body: Body) -> None:
    if body.clamped and not body.grounded:
        message = "found clamped nodes, expected a grounded body; add 'grounded: true'"
        subject.problems.add((*place, "clamped"), message)
