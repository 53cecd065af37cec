"""A tiny writer of EXTSEOUT(DMIGOP2), by the documented records."""

from __future__ import annotations

import struct
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from prs_model.reduction import SuperElement

GRID, GRID_DOUBLE, CORD2R = (4501, 45, 1), (4501, 45, 1120001), (2101, 21, 8)
SPOINT, DMIG = (5551, 49, 105), (114, 1, 120)
END = struct.pack("<2i", -1, -1)


def record(data: bytes) -> bytes:
    return struct.pack("<i", len(data)) + data + struct.pack("<i", len(data))


def key(*values: int) -> bytes:
    return b"".join(record(struct.pack("<i", value)) for value in values)


def block(name: str, records: Iterable[bytes]) -> bytes:
    """Name, trailer, then records numbered from -2, each of one chunk, and an empty last one."""
    out = key(2) + record(name.ljust(8).encode()) + key(-1, 7) + record(struct.pack("<7i", 101, 0, 0, 0, 0, 0, 0))
    number = -2
    for data in records:
        out += key(number, 1, 0, len(data) // 4) + record(data)
        number -= 1
    return out + key(number, 1, 0, 0)


def dmig(matrix: np.ndarray, dofs: list[tuple[int, int]], end: bytes) -> bytes:
    out = struct.pack("<3i8s7i", *DMIG, b"EXTDB   ", 0, 6, 2, 2, 0, 0, len(matrix))
    for column, label in enumerate(dofs):
        out += struct.pack("<2i", *label)
        for row in range(column, len(dofs)):
            if matrix[row, column]:
                out += struct.pack("<2id", *dofs[row], matrix[row, column])
        out += END
    return out + end


def write_extdb(
    path: Path,
    element: SuperElement,
    *,
    directory: Iterable[str] | None = None,
    double: bool = True,
    end: bytes = END,
) -> Path:
    """In SI. directory: names of the data blocks there. double: places. end: of each matrix."""
    layout, head = ("<2i3d3i", GRID_DOUBLE) if double else ("<2i3f3i", GRID)
    places = zip(element.nodes, element.positions, strict=True)
    grids = b"".join(struct.pack(layout, int(node), 0, *place, 0, 0, 0) for node, place in places)
    modes = [900 + index for index in range(element.n_modes)]
    dofs = [(int(node), component) for node in element.nodes for component in range(1, 7)] + [
        (mode, 0) for mode in modes
    ]
    system = struct.pack("<4i9f", 5, 1, 2, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0)
    blocks = {
        "GEOM1EX": [b"GEOM1   ", struct.pack("<3i", *CORD2R) + system, struct.pack("<3i", *head) + grids],
        "GEOM2EX": [b"GEOM2   ", struct.pack("<3i", *SPOINT) + struct.pack(f"<{len(modes)}i", *modes)],
        "MATK": [b"EXTDB   ", dmig(element.stiffness, dofs, end)],
        "MATM": [b"EXTDB   ", dmig(element.mass, dofs, end)],
    }
    names = list(directory) if directory is not None else list(blocks)
    listed = [name.ljust(8).encode() for name in ("XSOP2DIR", "PVT0", *names)]
    head_ = key(3) + record(struct.pack("<3i", 1, 2, 26)) + key(7) + record(b"NASTRAN FORT TAPE ID CODE - ")
    head_ += key(2) + record(b"NX2019  ") + key(-1, 0)
    data = head_ + block("XSOP2DIR", listed) + block("PVT0", [b"PVT0    "])
    path.write_bytes(data + b"".join(block("EXTDB", records) for records in blocks.values()) + key(0))
    return path
