"""Validation errors of pydantic in our words: what was found, what was expected, what to do."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError
from pydantic_core import ErrorDetails

from .fields import known_fields, types_at, without_tags
from .problems import Place, Problems, closest, did_you_mean, listed

_EXPECTED = {
    "string_type": "text",
    "bool_type": "true or false",
    "int_type": "a whole number",
    "float_type": "a number",
    "tuple_type": "a list, such as [1, 2, 3]",
    "list_type": "a list, such as [1, 2, 3]",
    "dict_type": "entries below it, such as 'name: value'",
    "model_type": "entries below it, such as 'name: value'",
    "model_attributes_type": "entries below it, such as 'name: value'",
}


def report(error: ValidationError, root: type[BaseModel], raw: Any, problems: Problems, base: Place = ()) -> None:
    """Add every error of a validation of `raw` against `root`; `base` is the place of `raw` in the file."""
    errors = error.errors(include_url=False)
    misspelt = {_meant(details, root) for details in errors if details["type"] == "extra_forbidden"}
    for details in errors:
        location = tuple(details["loc"])
        if details["type"] == "missing" and location in misspelt:
            continue  # told where the misspelt key is
        if details["type"] == "too_short" and _has_errors_below(errors, location):
            continue  # items that are wrong were not counted
        missing = details["type"] == "missing"
        place = (*base, *without_tags(raw, location, missing=missing))
        message = _message(details, root, location)
        if missing and isinstance(location[-1], int):
            place, message = place[:-1], _short_list(details, root, location[:-1])
        problems.add(place, message)


def _has_errors_below(errors: Sequence[ErrorDetails], location: Place) -> bool:
    places = [tuple(each["loc"]) for each in errors]
    return any(len(place) > len(location) and place[: len(location)] == location for place in places)


def _message(details: ErrorDetails, root: type[BaseModel], location: Place) -> str:
    kind, found = details["type"], details["input"]
    context = details.get("ctx", {})
    if kind == "missing":
        return f"found nothing, expected an entry; add '{location[-1]}'"
    if kind == "extra_forbidden":
        known = known_fields(root, location[:-1])
        expected = f"one of {listed(known, 30)}{did_you_mean(location[-1], known)}" if known else "no entries"
        return f"found an unknown key, expected {expected}"
    if kind == "literal_error":
        choices = [str(choice) for choice in _choices(root, location)]
        return f"found {shown(found)}, expected one of {listed(choices)}{did_you_mean(found, choices)}"
    if kind in ("union_tag_invalid", "union_tag_not_found"):
        return _tag_message(kind, found, context)
    if kind in ("too_long", "too_short"):
        limits = (
            f"at {'most' if kind == 'too_long' else 'least'} {context.get('max_length', context.get('min_length'))}"
        )
        return f"found {context.get('actual_length')} entries, expected {limits}"
    if location and location[-1] in ("int", "str"):
        return f"found {shown(found)}, expected a name or a whole number"
    if kind in _EXPECTED:
        return f"found {shown(found)}, expected {_EXPECTED[kind]}{_advice(kind, found)}"
    if kind == "greater_than_equal":
        return f"found {shown(found)}, expected {context['ge']} or more"
    message = details["msg"]
    return message if message.startswith("found ") else f"found {shown(found)}; {message}"


def _meant(details: ErrorDetails, root: type[BaseModel]) -> Place:
    """Where the entry would be that an unknown key is a misspelling of."""
    *section, name = details["loc"]
    close = closest(name, known_fields(root, tuple(section)))
    return (*section, close) if close else ()


def _choices(root: type[BaseModel], location: Place) -> tuple[Any, ...]:
    return tuple(choice for kind in types_at(root, location) for choice in get_args(kind))


def _tag_message(kind: str, found: Any, context: Mapping[str, Any]) -> str:
    names = [name.strip(" '") for name in str(context.get("expected_tags", "")).split(",") if name.strip(" '")]
    if kind == "union_tag_invalid":
        tag = context.get("tag", "")
        return f"found kind '{tag}', expected one of {listed(names)}{did_you_mean(tag, names)}"
    return f"found {shown(found)}, expected entries with a 'kind'"


def _short_list(details: ErrorDetails, root: type[BaseModel], location: Place) -> str:
    """A list of fixed length in which items are missing; pydantic reports each of them apart."""
    found = details["input"]
    lengths = [len(get_args(kind)) for kind in types_at(root, location) if get_args(kind)]
    expected = max(lengths, default=0)
    return f"found {len(found)} entries, expected {expected}"


def _advice(kind: str, found: Any) -> str:
    if kind == "string_type" and found is not None and not isinstance(found, Mapping | tuple):
        return "; put it in quotes"
    if kind == "bool_type" and str(found).lower() in ("yes", "no", "on", "off", "true", "false"):
        return ", without quotes and in small letters"
    return ""


def shown(found: Any) -> str:
    """A value of the file, short enough for a sentence."""
    if found is None:
        return "nothing"
    if isinstance(found, bool):
        return str(found).lower()
    if isinstance(found, str):
        return f"'{found[:60]}'"
    if isinstance(found, Mapping):
        return f"entries {listed(map(str, found), 6)}" if found else "no entries"
    if isinstance(found, tuple | list):
        return f"a list of {len(found)}"
    if isinstance(found, float) and math.isfinite(found):
        return f"{found:g}"
    return str(found)
