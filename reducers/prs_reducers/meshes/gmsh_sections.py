"""Sections of gmsh's text files hold as many lines as they say: meshio leaves out what goes beyond."""

from __future__ import annotations

from itertools import takewhile
from pathlib import Path

from prs_model.errors import PartFileError
from prs_model.part_files.text import read_bytes


def check_sections(path: Path) -> None:
    """Raises PartFileError when a text file of version 2.2 or 4.1 has more or fewer nodes or elements than it says."""
    lines = [line.strip() for line in read_bytes(path).splitlines()]
    if b"$MeshFormat" not in lines:
        return
    version, binary = (*lines[lines.index(b"$MeshFormat") + 1].split(), b"", b"")[:2]
    if binary != b"0" or version not in (b"2.2", b"4.1"):
        return
    for name, lines_each in (("Nodes", 2), ("Elements", 1)):
        section = _section(lines, f"${name}".encode())
        try:
            whole = _whole_22(section) if version == b"2.2" else _whole_41(section, lines_each)
        except (ValueError, IndexError):
            whole = False
        if not whole:
            raise PartFileError(path, f"${name}: found more or fewer lines than it says: damaged, write it again")


def _section(lines: list[bytes], start: bytes) -> list[bytes]:
    end = start.replace(b"$", b"$End")
    after = lines[lines.index(start) + 1 :] if start in lines else []
    return [line for line in takewhile(lambda line: line != end, after) if line]


def _whole_22(section: list[bytes]) -> bool:
    """The count, then as many lines."""
    return int(section[0]) == len(section) - 1


def _whole_41(section: list[bytes], lines_each: int) -> bool:
    """Numbers of blocks and of entries; each block a line that ends with its count, then so many lines an entry."""
    blocks, entries = map(int, section[0].split()[:2])
    at, found = 1, 0
    for _ in range(blocks):
        count = int(section[at].split()[3])
        at, found = at + 1 + lines_each * count, found + count
    return (at, found) == (len(section), entries)
