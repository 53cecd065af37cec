"""Standard output for results alone, standard error for everything else, whatever state they are in."""

from __future__ import annotations

import io
import logging
import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import TextIO

from ..errors import PrsError

_OUT, _ERR = 1, 2


def make_usable() -> None:
    """Let every text be printed, if need be as ``\\xe9``; a closed standard error takes it without a trace."""
    if sys.stderr is None:
        _occupy(_ERR)
        sys.stderr = open(os.devnull, "w")  # noqa: SIM115 - for the rest of the process
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")


def results() -> TextIO:
    """Standard output. Raises PrsError when it is closed: a result that is lost is no success."""
    if sys.stdout is None:
        raise PrsError("standard output is closed, so that no result can be printed; send it to a file or a terminal")
    return sys.stdout


def results_alone() -> TextIO:
    """As `results`, with nothing else in it: whatever is printed from now on goes to standard error.

    Compiled libraries write to descriptor 1 themselves, some of them only when the process ends. The stream returned
    therefore has a descriptor of its own, and descriptor 1 stays with standard error.
    """
    stream = results()
    if isinstance(stream, io.TextIOWrapper) and _is_descriptor(stream, _OUT):
        stream.flush()
        own = os.dup(_OUT)
        os.dup2(_ERR, _OUT)
        stream = sys.stdout = open(own, "w", encoding=stream.encoding, errors=stream.errors)  # noqa: SIM115
    return stream


def emit(text: str, stream: TextIO) -> None:
    """Print a result. Raises PrsError when it cannot be written, BrokenPipeError when nobody reads it."""
    try:
        print(text, file=stream, flush=True)
    except OSError as error:
        _give_up(stream)
        if isinstance(error, BrokenPipeError):
            raise
        raise PrsError(f"the result cannot be printed: {error.strerror}") from error


def complain(text: str) -> None:
    """Print a message on standard error, if that is possible."""
    try:
        print(f"prs-model: {text}", file=sys.stderr, flush=True)
    except OSError:
        _give_up(sys.stderr)


@contextmanager
def messages(*, quiet: bool) -> Iterator[None]:
    """The library's log on standard error: progress and warnings, or warnings only."""
    log, handler = logging.getLogger("prs_model"), logging.StreamHandler(sys.stderr)
    before = log.level
    log.addHandler(handler)
    log.setLevel(logging.WARNING if quiet else logging.INFO)
    try:
        yield
    finally:
        log.removeHandler(handler)
        log.setLevel(before)


def _give_up(stream: TextIO) -> None:
    """Drop what a stream still holds, so that the interpreter does not fail on it when it ends."""
    with suppress(OSError):
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, stream.fileno())
        os.close(null)


def _is_descriptor(stream: TextIO, number: int) -> bool:
    try:
        return stream.fileno() == number
    except OSError:
        return False


def _occupy(descriptor: int) -> None:
    """Keep a closed descriptor from being given to the next file that is opened."""
    try:
        os.fstat(descriptor)
    except OSError:
        null = os.open(os.devnull, os.O_WRONLY)
        if null != descriptor:
            os.dup2(null, descriptor)
            os.close(null)
