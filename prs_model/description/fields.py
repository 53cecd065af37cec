"""What may stand at a place of a file: the sections' types followed along the keys."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any, Literal, get_args, get_origin

from pydantic import BaseModel

from .problems import Place


def known_fields(root: type[BaseModel], place: Place) -> tuple[str, ...]:
    """Names of the entries that the section at `place` may have; empty where names are free.

    `place` may hold pydantic's union tags between keys, as its error locations do.
    """
    types = types_at(root, place)
    return tuple(dict.fromkeys(name for kind in types if _is_section(kind) for name in kind.model_fields))


def is_free(root: type[BaseModel], place: Place) -> bool:
    """Whether the entries at `place` carry names of the user's (bodies, joints, options ..)."""
    return any(get_origin(kind) is dict or kind is Any for kind in types_at(root, place))


def types_at(root: type[BaseModel], place: Place) -> tuple[Any, ...]:
    """The types a value at `place` may have; unions are opened."""
    types: tuple[Any, ...] = (root,)
    for step in place:
        inner = tuple(found for kind in types for found in _step(kind, step))
        types = inner or tuple(kind for kind in types if _is_tagged(kind, step)) or types
    return types


def _step(kind: Any, step: str | int) -> Iterator[Any]:
    if kind is Any:
        yield Any
    elif _is_section(kind) and step in kind.model_fields:
        field = kind.model_fields[step]
        yield from _opened(field.annotation)
    elif get_origin(kind) is dict and isinstance(step, str):
        yield from _opened(get_args(kind)[1])
    elif get_origin(kind) is tuple and isinstance(step, int):
        items = get_args(kind)
        if items[-1] is Ellipsis:
            yield from _opened(items[0])
        elif step < len(items):
            yield from _opened(items[step])


def _opened(kind: Any) -> Iterator[Any]:
    """The members of a union, or the type itself, without annotations."""
    if get_origin(kind) is Annotated:
        yield from _opened(get_args(kind)[0])
    elif get_args(kind) and get_origin(kind) not in (dict, tuple, list, Literal):
        for member in get_args(kind):
            yield from _opened(member)
    else:
        yield kind


def _is_section(kind: Any) -> bool:
    return isinstance(kind, type) and issubclass(kind, BaseModel)


def _is_tagged(kind: Any, tag: str | int) -> bool:
    """Whether a section is the one its union chose for `tag`, by its ``kind:``."""
    field = kind.model_fields.get("kind") if _is_section(kind) else None
    return field is not None and tag in get_args(field.annotation)


def without_tags(raw: Any, place: Sequence[str | int], *, missing: bool = False) -> Place:
    """pydantic's location as a place in the file: union tags, which are no entries, are left out.

    With `missing` the last step is kept although nothing is written there: it names what is missing.
    """
    kept: list[str | int] = []
    for number, step in enumerate(place):
        written = step in raw if isinstance(raw, Mapping) else isinstance(raw, tuple) and step in range(len(raw))
        if written:
            raw = raw[step]
        elif not missing or number < len(place) - 1:
            continue
        kept.append(step)
    return tuple(kept)
