"""The words of the command line: as it was given, and for what the library says of arguments and entries."""

from __future__ import annotations

import re
import shlex
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from ..errors import PrsError

_SAID = (
    (r"\breduce\('\w+', \.\.\.\): ", ""),
    (r"\bpart [^:\n]+: options\.", "--set "),
    (r"\b(?:bodies\.[^.\s]+\.)?options\.", "--set "),
    (r"\binterfaces\.(?=\w)", "--interface "),
    (r"\bexpected\.(?=\w+: )", "--expect "),
    (r"'grounded: true'", "--grounded"),
    (r"'units'", "--units"),
    (r"; correct 'source'", ""),
    (r"\b(modes|coupling|grounded|clamped): ", r"--\1: "),
)


def command_line() -> str:
    """The command line as it was given."""
    return shlex.join(["prs-model", *sys.argv[1:]])


@contextmanager
def in_words_of_the_command(reducer: str) -> Iterator[None]:
    """Errors speak of ``--set material.E`` where the library speaks of ``options.material.E``, and so on."""
    try:
        yield
    except PrsError as error:
        text = str(error)
        for pattern, words in _SAID:
            text = re.sub(pattern, words, text)
        if text == str(error):
            raise
        raise PrsError(text) from error
