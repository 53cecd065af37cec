"""The entries of a section in words, for people who fill it in."""

from __future__ import annotations

import json
from collections.abc import Iterator
from types import NoneType, UnionType
from typing import Annotated, Any, Literal, NamedTuple, Union, get_args, get_origin

from pydantic.fields import FieldInfo

from ..description.schema import Section
from ..description.units import SI, Dimension

_PLAIN: dict[Any, str] = {str: "text", int: "whole number", bool: "true or false", float: "number", Any: "anything"}


class Entry(NamedTuple):
    """Where it stands, what is written there, and what holds without it ('required' where nothing does)."""

    name: str
    kind: str
    default: str


def entries(section: type[Section], path: str = "") -> Iterator[Entry]:
    """Every entry of a section and of those inside it; ``<name>`` stands for the user's names, ``[]`` for a list."""
    for name, field in section.model_fields.items():
        kind = _whole(field)
        here = f"{path}.{name}" if path else name
        yield Entry(here, _words(kind), _default(field))
        for suffix, inner in _sections(kind):
            yield from entries(inner, here + suffix)


def _whole(field: FieldInfo) -> Any:
    """The type as it was written: pydantic keeps what annotates it apart."""
    return Annotated[(field.annotation, *field.metadata)] if field.metadata else field.annotation


def _default(field: FieldInfo) -> str:
    if field.is_required():
        return "required"
    value = field.get_default(call_default_factory=True)
    return "" if value is None or isinstance(value, Section) or value in ((), {}) else json.dumps(value)


def _words(kind: Any) -> str:
    """Such as ``N/m^2``, ``text``, ``[m, m, m]``, ``{name: entries}``."""
    origin, inside = get_origin(kind), get_args(kind)
    if origin is Annotated:
        dimension = next((each.dimension for each in inside[1:] if hasattr(each, "dimension")), None)
        unit = "number" if dimension == Dimension() else dimension.label(SI) if dimension else ""
        return unit or _words(inside[0])
    if origin in (Union, UnionType):
        return " or ".join(dict.fromkeys(_words(each) for each in inside if each is not NoneType))
    if origin is Literal:
        return " | ".join(map(str, inside))
    if origin is tuple and all(get_origin(each) is tuple and len(get_args(each)) == 6 for each in inside):
        return f"{len(inside)} x 6 numbers"
    if origin is tuple:
        return f"[{', '.join('..' if each is Ellipsis else _words(each) for each in inside)}]"
    if origin is dict:
        return f"{{name: {_words(inside[1])}}}"
    return _PLAIN.get(kind, "entries")


def _sections(kind: Any, suffix: str = "") -> Iterator[tuple[str, type[Section]]]:
    """The sections inside a type, and how a path goes on to them."""
    origin, inside = get_origin(kind), get_args(kind)
    if isinstance(kind, type) and origin is None and issubclass(kind, Section):
        yield suffix, kind
    elif origin is Annotated:
        yield from _sections(inside[0], suffix)
    elif origin is dict:
        yield from _sections(inside[1], f"{suffix}.<name>")
    elif origin is tuple:
        for each in dict.fromkeys(inside):
            yield from _sections(each, f"{suffix}[]")
    elif origin in (Union, UnionType):
        for each in inside:
            yield from _sections(each, suffix)
