"""The recipe of a reduced part: everything that determines the result, in one canonical text with a fingerprint."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from ..description.interface import Interface
from ..description.schema import Body
from ..description.section import Section
from ..description.settings import Settings as Settings

VERSION = 4  # raised when the reduction itself changes its results


def recipe(body: Body, options: Section, settings: Settings, reducer_version: int = 1) -> str:
    """Canonical JSON, in SI. The part's place in the machine (frame, joint it travels with) is left out."""
    content = {
        "version": VERSION,
        "reducer": body.reducer,
        "reducer_version": reducer_version,
        "source": body.source,
        "units": body.units,
        "options": _plain(options),
        "interfaces": {name: _interface(each, settings) for name, each in body.interfaces.items()},
        "order": list(body.interfaces),
        "clamped": sorted(body.clamped),
        "grounded": body.grounded,
        "method": settings.method,
        **({"modes": settings.modes} if _are_modes_stored(body, settings) else {}),
    }
    return json.dumps(content, sort_keys=True, separators=(",", ":"))


def _are_modes_stored(body: Body, settings: Settings) -> bool:
    """Joint-loaded parts are stored without; a contact with a node per station does not await joints, though."""
    travels = [interface.travel for interface in body.interfaces.values() if interface.travel is not None]
    return settings.method == "craig-bampton" or any(travel.method == "stations" for travel in travels)


def fingerprint(text: str) -> str:
    """The first twelve hexadecimal digits of the SHA-256 of a recipe."""
    return hashlib.sha256(text.encode()).hexdigest()[:12]


def file_hash(path: Path) -> str:
    """SHA-256 of a file's content."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def differences(wanted: str, stored: str) -> list[str]:
    """Entries in which two recipes differ, such as ``modes: 3, stored 5``."""
    new, old = dict(_leaves(json.loads(wanted))), dict(_leaves(json.loads(stored)))
    places = sorted(new.keys() | old.keys())
    return [
        f"{place}: {new.get(place, 'nothing')}, stored {old.get(place, 'nothing')}"
        for place in places
        if new.get(place) != old.get(place)
    ]


def _interface(interface: Interface, settings: Settings) -> dict[str, Any]:
    content: dict[str, Any] = _plain(interface)
    content["coupling"] = settings.coupling_of(interface)
    if interface.members:
        content["tie"] = settings.tie_of(interface)
    if interface.travel is not None:
        del content["travel"]["joint"]
    return content


def _plain(value: Any) -> Any:
    """Sections, tuples and quantities as JSON has them; numbers to twelve digits, so that units do not matter."""
    if isinstance(value, Section):
        return {
            name: _plain(getattr(value, name))
            for name, info in type(value).model_fields.items()
            if getattr(value, name) != info.get_default(call_default_factory=True)
        }
    if isinstance(value, Mapping):
        return {str(name): _plain(each) for name, each in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(each) for each in value]
    if isinstance(value, float):
        return float(f"{value:.12g}")
    return value


def _leaves(value: Any, place: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, dict):
        for name, each in value.items():
            yield from _leaves(each, f"{place}.{name}" if place else name)
    else:
        yield place, value
