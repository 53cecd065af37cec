"""Symmetry: an entry written once ``per: limb`` becomes one instance for each limb."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Protocol, TypeVar

from pydantic import BaseModel

Symmetry = Mapping[str, tuple[int | str, ...]]


class _Entry(Protocol):
    @property
    def per(self) -> str | None: ...


E = TypeVar("E", bound=_Entry)


@dataclass(frozen=True)
class Instance:
    """One of the things an entry stands for: its own name and what its placeholder is replaced with."""

    name: str
    entry: str
    replacements: Mapping[str, str]


def instances(name: str, per: str | None, symmetry: Symmetry) -> Iterator[Instance]:
    """The instances of an entry: ``rod_1``, ``rod_2`` .. for ``per: limb``; itself where it has no (known) symmetry."""
    if per is None or per not in symmetry:
        yield Instance(name, name, {})
        return
    for member in symmetry[per]:
        yield Instance(f"{name}_{member}", name, {f"<{per}>": str(member)})


def expanded(entries: Mapping[str, E], symmetry: Symmetry) -> dict[str, E]:
    """All instances by name, with the placeholders replaced in every text inside, keys included."""
    return {
        instance.name: substituted(entry, instance.replacements)
        for name, entry in entries.items()
        for instance in instances(name, entry.per, symmetry)
    }


def substituted(value: Any, replacements: Mapping[str, str]) -> Any:
    """A copy of a section, mapping, sequence or text with every placeholder replaced."""
    if not replacements:
        return value
    if isinstance(value, str):
        for placeholder, text in replacements.items():
            value = value.replace(placeholder, text)
        return value
    if isinstance(value, BaseModel):
        changed = {key: substituted(getattr(value, key), replacements) for key in value.model_fields_set}
        return value.model_copy(update=changed)
    if isinstance(value, Mapping):
        return {substituted(key, replacements): substituted(item, replacements) for key, item in value.items()}
    if isinstance(value, tuple):
        return tuple(substituted(item, replacements) for item in value)
    return value
