"""YAML as people expect it, with lines, and without anything that runs or grows."""

from __future__ import annotations

import math
from typing import Any

import pytest

from prs_model.description import parse_value
from prs_model.description.yaml_loader import MAX_DEPTH, parse_yaml
from prs_model.errors import DescriptionError


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("1e-6", 1e-6),
        ("4.0e5", 4.0e5),
        (".5", 0.5),
        ("-3.", -3.0),
        ("+7", 7),
        ("010", 10),
        ("0x1F", 31),
        ("-.inf", -math.inf),
        ("true", True),
        ("yes", "yes"),
        ("off", "off"),
        ("1_000", "1_000"),
        ("2024-01-01", "2024-01-01"),
        ("12:30", "12:30"),
        ("'1e-6'", "1e-6"),
        ("~", None),
        ("", None),
        ("[1, two, [3.5]]", (1, "two", (3.5,))),
        ("{value: 2e3, source: paper}", {"value": 2000.0, "source": "paper"}),
        ("rod_v2.op4", "rod_v2.op4"),
    ],
)
def test_scalars(text: str, value: Any) -> None:
    read = parse_value(text)
    assert read == value
    assert type(read) is type(value)


def test_every_entry_knows_its_line() -> None:
    text = "a: 1\nb:\n  c:\n    - x\n    - {d: 2,\n       e: 3}\n"
    lines = parse_yaml(text).lines
    assert {
        place: lines[place] for place in [("a",), ("b", "c"), ("b", "c", 0), ("b", "c", 1, "d"), ("b", "c", 1, "e")]
    } == {
        ("a",): 1,
        ("b", "c"): 3,
        ("b", "c", 0): 4,
        ("b", "c", 1, "d"): 5,
        ("b", "c", 1, "e"): 6,
    }


def test_what_is_written_wins_over_what_is_merged() -> None:
    document = parse_yaml("a: &a {x: 1, y: 2}\nb: &b {y: 3, z: 4}\nc:\n  <<: [*a, *b]\n  x: 5\n")
    assert document.value["c"] == {"x": 5, "y": 2, "z": 4}
    assert document.lines[("c", "z")] == 2


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a: 1\nb: {c: 1, c: 2}\n'a': 3\n", "'a' a second time"),
        ("a: !!python/object/apply:os.system [ls]\n", "tag"),
        ("a: &a [1, *a]\n", "alias to something that contains it"),
        ("a: &a {<<: *a}\n", "alias to something that contains it"),
        ("? [1, 2]\n: 3\n", "list or mapping as a key"),
        ("a: 1\n---\nb: 2\n", "another document"),
        ("a: \x01\n", "special character"),
        ("", "empty"),
        ("[" * (MAX_DEPTH + 1), "levels deep"),
        ("[" * 100_000, "levels deep"),
    ],
)
def test_what_is_refused(text: str, words: str) -> None:
    with pytest.raises(DescriptionError, match=words):
        parse_yaml(text)


@pytest.mark.parametrize("form", ["[{}]", "{{<<: [{}]}}"])
def test_aliases_cannot_grow_without_bound(form: str) -> None:
    levels = [f"a{level + 1}: &a{level + 1} " + form.format(", ".join([f"*a{level}"] * 9)) for level in range(12)]
    with pytest.raises(DescriptionError, match="after following the aliases"):
        parse_yaml("a0: &a0 {x: 1}\n" + "\n".join(levels))
