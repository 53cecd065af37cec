"""YAML as people expect it: ``1e-6`` is a number, ``no`` is a word, a key stands once, and every entry knows its line.

The text is composed by PyYAML and constructed here, with the scalar rules of YAML 1.2: no tag can run code.
Sequences become tuples, keys are always text. Anchors, aliases and ``<<`` merges work.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import yaml

from ..errors import DescriptionError, Problem
from .problems import Place, dotted

MAX_DEPTH = 40
MAX_ENTRIES = 200_000  # after aliases are followed

_PLAIN, _QUOTED, _MAPPING, _SEQUENCE = "plain", "quoted", "mapping", "sequence"
_TEXT_TAG = "tag:yaml.org,2002:str"
_INTEGER = re.compile(r"[-+]?[0-9]{1,300}")  # longer ones are read as numbers that are not finite
_BASED = re.compile(r"0o[0-7]+|0x[0-9a-fA-F]+")
_FLOAT = re.compile(r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?")
_WORDS: dict[str, Any] = {
    "": None,
    "~": None,
    "null": None,
    "true": True,
    "false": False,
    ".inf": float("inf"),
    "+.inf": float("inf"),
    "-.inf": float("-inf"),
    ".nan": float("nan"),
}


@dataclass(frozen=True)
class Document:
    """What a YAML file holds, and the line of every entry by its place."""

    value: Any
    lines: dict[Place, int | None]


def read_yaml(path: Path) -> Document:
    """Read a YAML file. Raises DescriptionError with the line for anything that is not the YAML described above."""
    try:
        text = path.read_bytes().decode("utf-8-sig")
    except OSError as error:
        raise _error(path.name, None, f"cannot be read: {error.strerror}") from error
    except UnicodeDecodeError as error:
        raise _error(path.name, None, f"found byte {error.start} that is not UTF-8, expected UTF-8 text") from error
    return parse_yaml(text, path.name)


def parse_yaml(text: str, file: str = "text") -> Document:
    """As read_yaml, from text; `file` is the name used in errors."""
    node = _compose(text, file)
    construction = _Construction(file)
    value = construction.value(node, ())
    if construction.problems:
        raise DescriptionError(construction.problems)
    return Document(value, construction.lines)


def parse_value(text: str) -> Any:
    """One value as it would be read in machine.yaml: number, true/false, text, list or mapping.

    Raises DescriptionError when the text is not YAML.
    """
    return parse_yaml(text, "value").value if text.strip() else None


def scalar(text: str) -> Any:
    """The value of an unquoted word."""
    if text in _WORDS:
        return _WORDS[text]
    if _INTEGER.fullmatch(text):
        return int(text)
    if _BASED.fullmatch(text):
        return int(text, 0)
    if _FLOAT.fullmatch(text):
        return float(text)
    return text


def _error(file: str, line: int | None, message: str, entry: str = "") -> DescriptionError:
    return DescriptionError([Problem(file, line, entry, message)])


class _Loader(yaml.SafeLoader):
    """Composes nodes that say whether a scalar was quoted, and stops at a sensible depth."""

    depth = 0

    def resolve(self, kind: type[yaml.Node], value: Any, implicit: Any) -> str:
        if kind is yaml.ScalarNode:
            return _PLAIN if implicit[0] else _QUOTED
        return _SEQUENCE if kind is yaml.SequenceNode else _MAPPING

    def compose_node(self, parent: yaml.Node | None, index: Any) -> yaml.Node | None:
        self.depth += 1
        if self.depth > MAX_DEPTH:
            mark = self.peek_event().start_mark  # type: ignore[no-untyped-call]
            raise yaml.MarkedYAMLError(problem=f"nested more than {MAX_DEPTH} levels deep", problem_mark=mark)
        node = super().compose_node(parent, index)
        self.depth -= 1
        return node


def _compose(text: str, file: str) -> yaml.Node:
    try:
        loader = _Loader(text)
        try:
            node = loader.get_single_node()
        finally:
            loader.dispose()
    except yaml.MarkedYAMLError as error:
        line = error.problem_mark.line + 1 if error.problem_mark else None
        hint = "; indent with spaces, not tabs" if "\\t" in str(error.problem) else ""
        message = ", ".join(filter(None, (error.context, error.problem)))
        raise _error(file, line, f"not valid YAML: {message}{hint}") from None
    except yaml.reader.ReaderError as error:
        line = text.count("\n", 0, error.position) + 1
        raise _error(file, line, f"not valid YAML: found the special character {error.character!r}") from None
    if node is None:
        raise _error(file, None, "found an empty file, expected a machine description")
    return node


@dataclass
class _Construction:
    """Turns nodes into dicts, tuples and scalars, and notes their lines."""

    file: str
    lines: dict[Place, int | None] = field(default_factory=dict)
    problems: list[Problem] = field(default_factory=list)
    _open: list[yaml.Node] = field(default_factory=list)
    _steps: int = 0

    def value(self, node: yaml.Node, place: Place) -> Any:
        self.lines[place] = node.start_mark.line + 1
        self._guard(node, place)
        if isinstance(node, yaml.ScalarNode):
            return scalar(node.value) if node.tag == _PLAIN else node.value
        self._open.append(node)
        result: Any
        if isinstance(node, yaml.MappingNode):
            entries = self._entries(node, place)
            result = {key: self._entry(line, item, (*place, key)) for key, line, item in entries}
        else:
            result = tuple(self.value(item, (*place, index)) for index, item in enumerate(node.value))
        self._open.pop()
        return result

    def _entry(self, line: int, node: yaml.Node, place: Place) -> Any:
        value = self.value(node, place)
        self.lines[place] = line
        return value

    def _guard(self, node: yaml.Node, place: Place) -> None:
        if node.tag not in (_PLAIN, _QUOTED, _MAPPING, _SEQUENCE, _TEXT_TAG):
            raise self._refuse(node, place, f"found the tag {node.tag}, expected none; tags are not used here")
        if node in self._open:
            raise self._refuse(node, place, "found an alias to something that contains it, expected a finite file")
        self._steps += 1
        if self._steps > MAX_ENTRIES:
            raise self._refuse(node, place, f"found more than {MAX_ENTRIES} entries after following the aliases")

    def _refuse(self, node: yaml.Node, place: Place, message: str) -> DescriptionError:
        return _error(self.file, node.start_mark.line + 1, message, dotted(place))

    def _entries(self, node: yaml.MappingNode, place: Place) -> Iterator[tuple[str, int, yaml.Node]]:
        """Key, line and value of each entry: first what is merged in and not overridden, then what is written."""
        written: dict[str, tuple[int, yaml.Node]] = {}
        merged: dict[str, tuple[int, yaml.Node]] = {}
        for key_node, value in node.value:
            line = key_node.start_mark.line + 1
            if not isinstance(key_node, yaml.ScalarNode):
                raise self._refuse(key_node, place, "found a list or mapping as a key, expected a name")
            key = key_node.value
            if key == "<<" and key_node.tag == _PLAIN:
                for name, at, item in self._merged(value, place):
                    merged.setdefault(name, (at, item))
            elif key in written:
                first = written[key][0]
                message = f"found the key '{key}' a second time (first on line {first}); keep one of the two"
                self.problems.append(Problem(self.file, line, dotted((*place, key)), message))
            else:
                written[key] = (line, value)
        for name, (line, item) in {**merged, **written}.items():
            yield name, line, item

    def _merged(self, node: yaml.Node, place: Place) -> Iterator[tuple[str, int, yaml.Node]]:
        sources = node.value if isinstance(node, yaml.SequenceNode) else [node]
        for source in sources:
            self._guard(source, place)
            if not isinstance(source, yaml.MappingNode):
                raise self._refuse(node, place, "found << without a mapping to merge, expected <<: *anchor")
            self._open.append(source)
            yield from self._entries(source, place)
            self._open.pop()
