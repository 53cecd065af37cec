"""Super-elements written for Nastran: OP4 with the companions of EXTSEOUT(MATOP4), and DMIG punch."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from prs_model.description.units import Units
from prs_model.errors import MissingExtraError, PartFileError
from prs_model.part_files import read_text
from prs_model.part_files.text import file_access
from prs_model.reduction import SuperElement
from prs_model.reduction.storage import whole

from .apart import EXTRA
from .notes import SIGNED, note_lines, signed
from .points import Points, components_of, pairs, points_of, scalars_of

NUMBER = 101  # of the superelement, and of the Fortran unit that the assembly run reads it from
SYSTEM = 1  # the first number of a coordinate system
EMPTY_BEFORE = ("BXX1", "K4XX1", "PX1", "GPXX", "GDXX", "RVAX")
EMPTY_BEHIND = (
    *("MUG1", "MUG1O", "MES1", "MES1O", "MEE1", "MEE1O", "MGPFM", "MGPFB", "MGPFK", "MGPFO", "MEF1", "MEF1O"),
    *("MQGM", "MQGB", "MQGK", "MQG1O", "MQMGM", "MQMGB", "MQMGK", "MQMG1O"),
)


def write_matop4(element: SuperElement, path: Path, units: Units) -> None:
    """Write KXX and MXX with every bit to .op4, and what their rows are to .asm and .pch, as EXTSEOUT(MATOP4) does.

    The .asm is for the main bulk data of an assembly run, the .pch for its end. Coordinates have the 16 characters of a
    field. The matrices that Nastran expects beside them are there as 1x1 zeros, and VA as ones: no damping, loads or
    data recovery. Raises MissingExtraError, or PartFileError, also where it would replace what others wrote.
    """
    points = points_of(element, path, units)
    _check_replaceable(path)
    data = _op4(points)
    head = note_lines(units, points.names, grounded=element.grounded)
    for suffix, lines in ((".asm", _assembly(points)), (".pch", _superelement(points))):
        _write(path.with_suffix(suffix), signed([*head, *lines]))
    _write(path, data)


def write_punch(element: SuperElement, path: Path, units: Units) -> None:
    """Write KAAX and MAAX as DMIG with GRID, CORD2R and SPOINT entries, in fields of 16 characters.

    Raises PartFileError, also where it would replace the companion of an .op4 or what others wrote.
    """
    if path.suffix.lower() == ".pch" and path.with_suffix(".op4").exists():
        raise PartFileError(
            path, f"would replace the companion of {path.with_suffix('.op4').name}: choose another name"
        )
    if path.exists() and SIGNED not in read_text(path):
        raise PartFileError(path, "is there already, and was not written by this program: choose another name")
    points = points_of(element, path, units)
    lines = [*note_lines(units, points.names, grounded=element.grounded), *_points(points)]
    for name, matrix in (("KAAX", points.stiffness), ("MAAX", points.mass)):
        lines += _dmig(name, points, (matrix + matrix.T) / 2.0)
    _write(path, signed(lines))


def real(value: float, letter: str = "E") -> str:
    """A real number in at most 16 characters, with as many digits as these hold."""
    for digits in range(14, -1, -1):
        mantissa, exponent = f"{value:.{digits}e}".split("e")
        text = f"{mantissa}{'' if '.' in mantissa else '.'}{letter}{int(exponent):+d}"
        if len(text) <= 16:
            return text
    raise ValueError(f"{value} does not fit into 16 characters")


def _op4(points: Points) -> bytes:
    try:
        from pyyeti.nastran import op4
    except ImportError as error:
        raise MissingExtraError(*EXTRA, purpose="writing .op4") from error
    zero = np.zeros((1, 1))
    matrices = [
        *(("KXX", points.stiffness, 6), ("MXX", points.mass, 6), *((name, zero, 6) for name in EMPTY_BEFORE)),
        *(("VA", np.ones((len(points.mass), 1)), 2), *((name, zero, 6) for name in EMPTY_BEHIND)),
    ]
    names, arrays, forms = (list(column) for column in zip(*matrices, strict=True))
    with TemporaryDirectory(prefix="prs-model-") as folder:
        file = Path(folder) / "part.op4"
        op4.write(str(file), names, arrays, binary=True, endian="<", forms=forms)
        return file.read_bytes()


def _write(path: Path, data: bytes) -> None:
    with file_access(path, "written"), whole(path) as file:
        file.write(data)


def _check_replaceable(path: Path) -> None:
    """Raises PartFileError where an .op4, .asm or .pch of this name is there that this program has not written."""
    companions = [path.with_suffix(suffix) for suffix in (".asm", ".pch")]
    for file, entry in zip(companions, ("SECONCT", "EXTRN"), strict=True):
        if file.exists() and not _is_our_companion(file, entry):
            raise PartFileError(file, f"would be replaced, but was not written beside {path.name}: choose another name")
    if path.exists() and not any(file.exists() for file in companions):
        raise PartFileError(path, "is there already, and was not written by this program: choose another name")


def _is_our_companion(file: Path, entry: str) -> bool:
    try:
        text = read_text(file)
    except PartFileError:
        return False
    names = {line[:8].split(",")[0].strip() for line in text.splitlines()}
    return SIGNED in text and entry in names and not names & {"DMIG", "DMIG*"}


def _assembly(points: Points) -> list[str]:
    both = [field for point, _ in components_of(points) for field in (str(point), str(point))]
    return [
        f"SEBULK  {NUMBER:>8}  EXTOP4          MANUAL                {NUMBER:>8}",
        *_small("SECONCT", [str(NUMBER), "0", "", "NO", "", "", "", "", *both]),
        *_points(points),
    ]


def _superelement(points: Points) -> list[str]:
    words = components_of(points)
    listed = [line for at in range(0, len(words), 4) for line in _small("ASET", pairs(words[at : at + 4]))]
    return [f"BEGIN SUPER {NUMBER:>8}", *_small("EXTRN", pairs(words)), *_points(points), *listed]


def _points(points: Points) -> Iterator[str]:
    """Coordinate systems, grid points and scalar points."""
    system = SYSTEM
    for grid, place, frame in zip(points.grids, points.coordinates, points.frames, strict=True):
        turned = not np.array_equal(frame, np.eye(3))
        if turned:
            corners = (*(0.0, 0.0, 0.0), *frame[:, 2], *frame[:, 0])
            yield from _large("CORD2R", [str(system), "0", *map(real, corners)])
        yield from _large("GRID", [str(grid), "0", *map(real, place), str(system if turned else 0)])
        system += turned
    scalars = scalars_of(points)
    for at in range(0, len(scalars), 8):
        yield from _small("SPOINT", list(map(str, scalars[at : at + 8])))


def _dmig(name: str, points: Points, matrix: np.ndarray) -> Iterator[str]:
    """A symmetric matrix: of each column what stands on and below the diagonal, where it is not zero."""
    n = len(matrix)
    yield from _small("DMIG", [name, "0", "6", "2", "0", "", "", str(n)])
    labels = [(str(point), str(c + 1)) for point, c in zip(points.points, points.components.tolist(), strict=True)]
    for column in range(n):
        rows = [row for row in range(column, n) if matrix[row, column] != 0.0]
        entries = [[*labels[row], real(matrix[row, column], "D"), ""] for row in rows]
        if entries:
            yield from _large("DMIG", [name, *labels[column], "", *(field for each in entries for field in each)])


def _small(name: str, fields: list[str]) -> Iterator[str]:
    return _entry(name, fields, 8, "")


def _large(name: str, fields: list[str]) -> Iterator[str]:
    return _entry(name, fields, 16, "*")


def _entry(name: str, fields: Iterable[str], width: int, mark: str) -> Iterator[str]:
    """Lines of 72 characters: the name or the mark of a continuation, and fields to the right."""
    cells = [f"{field:>{width}}" for field in fields]
    per_line = 64 // width
    for at in range(0, len(cells), per_line):
        head = name + mark if at == 0 else mark
        yield f"{head:<8}{''.join(cells[at : at + per_line])}".rstrip()
