"""Labels of nodes in gmsh's .msh files, which meshio reads and drops."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from prs_model.arrays import FloatArray, IntArray
from prs_model.part_files.text import read_bytes


def node_labels(path: Path, points: FloatArray) -> IntArray | None:
    """(n,) gmsh's tags of points (n, 3), which stand in the file's order; None for other formats and older versions.

    Tags are given only where the file's own coordinates are those of `points`, number for number.
    """
    data = read_bytes(path)
    try:
        labels, own = _nodes(data)
    except (ValueError, IndexError, OverflowError):
        return None
    return labels if own.shape == points.shape and np.array_equal(own, points) else None


def _nodes(data: bytes) -> tuple[IntArray, FloatArray]:
    """Tags and coordinates of the $Nodes section. Raises ValueError or IndexError for what it is not."""
    version, binary = data[data.index(b"$MeshFormat") + 11 :].split(maxsplit=2)[:2]
    start = data.index(b"\n", data.index(b"$Nodes")) + 1
    section = data[start : data.index(b"$EndNodes", start)]
    if binary == b"0":
        return {b"2.2": _ascii_22, b"4.1": _ascii_41}.get(version, _unknown)(section)
    return {b"2.2": _binary_22, b"4.1": _binary_41}.get(version, _unknown)(section)


def _unknown(section: bytes) -> tuple[IntArray, FloatArray]:
    raise ValueError("a version of the format that is not read")


def _ascii_22(section: bytes) -> tuple[IntArray, FloatArray]:
    """A line with the count, then lines of tag, x, y, z."""
    words = section.split()
    table = np.array(words[1 : 1 + 4 * int(words[0])], dtype=float).reshape(-1, 4)
    return table[:, 0].astype(np.int64), table[:, 1:]


def _ascii_41(section: bytes) -> tuple[IntArray, FloatArray]:
    """Blocks of nodes on one entity: a line of four numbers, the last the count, then all tags, then all x, y, z."""
    words, at = section.split(), 4
    tags: list[bytes] = []
    places: list[bytes] = []
    for _ in range(int(words[0])):
        count, at = int(words[at + 3]), at + 4
        tags += words[at : at + count]
        places += words[at + count : at + 4 * count]
        at += 4 * count
    return np.array(tags, dtype=np.int64), np.array(places, dtype=float).reshape(-1, 3)


def _binary_22(section: bytes) -> tuple[IntArray, FloatArray]:
    count, _, rest = section.partition(b"\n")
    nodes = np.frombuffer(rest, dtype=[("tag", "<i4"), ("x", "<f8", (3,))], count=int(count))
    return nodes["tag"].astype(np.int64), nodes["x"]


def _binary_41(section: bytes) -> tuple[IntArray, FloatArray]:
    tags, places, at = [], [], 32
    for _ in range(int(np.frombuffer(section, "<u8", 1)[0])):
        count = int(np.frombuffer(section, "<u8", 1, at + 12)[0])
        tags.append(np.frombuffer(section, "<u8", count, at + 20))
        places.append(np.frombuffer(section, "<f8", 3 * count, at + 20 + 8 * count))
        at += 20 + 32 * count
    return np.concatenate(tags).astype(np.int64), np.concatenate(places).reshape(-1, 3)
