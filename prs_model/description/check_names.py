"""Names and symmetry: what things may be called, ``per`` and ``<placeholders>``."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from typing import Any

from .expand import instances
from .problems import Place, listed, not_known
from .subject import Subject

_NAME = re.compile(r"[A-Za-z0-9_-]+")
_PLACEHOLDER = re.compile(r"<([A-Za-z0-9_-]+)>")
_FREE_TEXT = ("note", "title")


def check_names(subject: Subject) -> None:
    """Check names, symmetry groups, ``per`` entries and placeholders."""
    _check_name(subject, ("name",), subject.file.name)
    _check_groups(subject)
    for kind in ("bodies", "joints", "closures"):
        _check_entries(subject, kind, getattr(subject.file, kind))
    for key, value in subject.raw.items():
        if key not in ("bodies", "joints", "closures"):
            allowed = tuple(subject.file.symmetry) if key == "task" else ()
            _check_placeholders(subject, (key,), value, allowed)
    for name, body in subject.file.bodies.items():
        for interface in body.interfaces:
            _check_name(subject, ("bodies", name, "interfaces", interface), _PLACEHOLDER.sub("1", interface))


def _check_groups(subject: Subject) -> None:
    for group, members in subject.file.symmetry.items():
        place = ("symmetry", group)
        _check_name(subject, place, group)
        if not members or len(set(map(str, members))) < len(members):
            subject.problems.add(place, f"found {list(members)}, expected one or more different members")
        for index, member in enumerate(members):
            _check_name(subject, (*place, index), str(member))


def _check_entries(subject: Subject, kind: str, entries: Mapping[str, Any]) -> None:
    taken: dict[str, str] = {}
    for name, entry in entries.items():
        place = (kind, name)
        if entry.per is not None and entry.per not in subject.file.symmetry:
            subject.problems.add((*place, "per"), not_known("a group of symmetry", entry.per, subject.file.symmetry))
        else:
            allowed = (entry.per,) if entry.per else ()
            _check_placeholders(subject, place, subject.raw[kind][name], allowed)
        _check_name(subject, place, name)
        for instance in instances(name, entry.per, subject.file.symmetry):
            if instance.name in taken:
                message = f"makes '{instance.name}', which '{taken[instance.name]}' makes too; rename one of the two"
                subject.problems.add(place, message)
            taken[instance.name] = name


def _check_name(subject: Subject, place: Place, name: str) -> None:
    if not _NAME.fullmatch(name) or name == "ground":
        subject.problems.add(place, f"found the name {name!r}, expected letters, digits, _ and - (and not 'ground')")


def _check_placeholders(subject: Subject, place: Place, raw: Any, allowed: tuple[str, ...]) -> None:
    symmetry = subject.file.symmetry
    for where, text in _texts(place, raw):
        for group in _PLACEHOLDER.findall(text):
            if group in allowed:
                continue
            known = listed(f"<{name}>" for name in allowed)
            advice = "" if allowed else f"; add 'per: {group}'" if group in symmetry else "; write the name out"
            subject.problems.add(where, f"found the placeholder <{group}>, expected {known} here{advice}")


def _texts(place: Place, raw: Any) -> Iterator[tuple[Place, str]]:
    """Every text with its place; a key stands at the place of its value."""
    if isinstance(raw, str):
        yield place, raw
    elif isinstance(raw, Mapping):
        for key, value in raw.items():
            if key not in _FREE_TEXT:
                yield (*place, key), key
                yield from _texts((*place, key), value)
    elif isinstance(raw, tuple):
        for index, value in enumerate(raw):
            yield from _texts((*place, index), value)
