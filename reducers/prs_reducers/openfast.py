"""OpenFAST's reduced substructures: ExtPtfm super-elements as text, and the summary that SubDyn writes."""

from __future__ import annotations

import logging
import re
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np
from pydantic import Field

from prs_model.arrays import FloatArray
from prs_model.description.quantity import Quantity
from prs_model.description.schema import Point, Section
from prs_model.description.units import SI
from prs_model.errors import PartFileError, short
from prs_model.linear_algebra import lowest_modes
from prs_model.part_files import MODE, LabelledMatrices, NodeTable, read_text, super_element
from prs_model.part_files.text import number
from prs_model.plugins import PartRequest, Reducer
from prs_model.reduction import SuperElement
from prs_model.reduction.super_element import AXES

logger = logging.getLogger("prs_model")

SAME_FREQUENCY = 1e-4  # SubDyn writes seven digits
_BLOCK = re.compile(r"^!\s*(mass|stiffness|damping) matrix", re.IGNORECASE)
_DIMENSION = re.compile(r"^!\s*dimension:?\s+(\d{1,9})\b", re.IGNORECASE)


class OpenfastOptions(Section):
    """point: where the interface node of an ExtPtfm file is, which does not say it (SubDyn does).

    components: what the rows of such a file are when they are not the six interface motions and then modes.
    """

    point: Point = (Quantity(0.0), Quantity(0.0), Quantity(0.0))
    components: tuple[Literal["ux", "uy", "uz", "rx", "ry", "rz", "mode"], ...] = Field(default=())


class OpenfastReducer(Reducer[OpenfastOptions]):
    """ExtPtfm (FlexASCII and GuyanASCII) and SubDyn's .sum.yaml, whichever the file is; one node, `interface`.

    Read: mass and stiffness. Damping and loads are checked and left out. A substructure whose base is clamped, as
    SubDyn's mostly is, must be declared grounded. Formats: OpenFAST, user's guide, ExtPtfm input files; SubDyn.
    """

    description: ClassVar[str] = "OpenFAST: ExtPtfm super-element text, SubDyn summary (.sum.yaml), SI"
    Options: ClassVar[type[Section]] = OpenfastOptions
    gives = "reduced"
    units = "SI"

    def read(self, part: PartRequest[OpenfastOptions]) -> SuperElement:
        """The super-element. Raises PartFileError naming the block that is wrong."""
        text, path = read_text(part.path), part.path
        head = [line.strip().lower() for line in text.splitlines()[:5]]
        if any("subdyn" in line for line in head):
            return _subdyn(text, path)
        if len(head) > 1 and "flex 5 format" in head[1]:
            return _element(path, *_flex(text, path), part.options)
        if len(head) > 1 and head[1].startswith("#mass"):
            return _element(path, *_guyan(text, path), part.options)
        raise PartFileError(
            path, "is neither an ExtPtfm file (second line '!.. Flex 5 Format' or '#Mass') nor a summary of SubDyn"
        )


def _element(path: Path, stiffness: FloatArray, mass: FloatArray, options: OpenfastOptions) -> SuperElement:
    n = len(stiffness)
    named = options.components
    if not named and n < 6:
        raise PartFileError(
            path,
            f"has {n} rows, expected the six interface motions of ExtPtfm and then modes; if its rows are others, say "
            "which as options.components, such as [ux, uy, uz]",
        )
    if named and len(named) != n:
        raise PartFileError(path, f"has {n} rows, and options.components names {len(named)}")
    return _super_element(
        path, stiffness, mass, named or (*AXES, *["mode"] * (n - 6)), np.array(options.point, dtype=float)
    )


def _super_element(
    path: Path, stiffness: FloatArray, mass: FloatArray, named: tuple[str, ...], point: FloatArray
) -> SuperElement:
    modes = iter(range(1, len(named) + 1))
    matrices = LabelledMatrices(
        source=path,
        stiffness=stiffness,
        mass=mass,
        nodes=np.array([str(next(modes)) if name == "mode" else "interface" for name in named]),
        components=np.array([MODE if name == "mode" else AXES.index(name) for name in named]),
    )
    return super_element(matrices, NodeTable(path, np.array(["interface"]), point.reshape(1, 3)), SI)


def _flex(text: str, path: Path) -> tuple[FloatArray, FloatArray]:
    """Stiffness and mass of FlexASCII: `!Dimension: n`, the three matrices by title, loads over time."""
    lines = text.splitlines()
    n = next((int(found[1]) for line in lines if (found := _DIMENSION.match(line.strip()))), None)
    if n is None:
        raise PartFileError(path, "has no line '!Dimension: n'")
    blocks: dict[str, FloatArray] = {}
    for at, line in enumerate(lines):
        title = _BLOCK.match(line.strip())
        if title is not None:
            name = title[1].lower()
            if name in blocks:
                raise PartFileError(path, f"line {at + 1}: a second {name} matrix")
            said = _DIMENSION.match(lines[at + 1].strip()) if at + 1 < len(lines) else None
            if said is not None and int(said[1]) != n:
                raise PartFileError(path, f"line {at + 2}: {name} matrix of dimension {said[1]}, the heading says {n}")
            blocks[name] = _square(lines, at + 2, n, f"{name} matrix", path)
    missing = [name for name in ("mass", "stiffness", "damping") if name not in blocks]
    if missing:
        raise PartFileError(path, f"has no '!{missing[0].capitalize()} Matrix': cut off, or of another kind")
    _check_loads(lines, n, path)
    return blocks["stiffness"], blocks["mass"]


def _check_loads(lines: list[str], n: int, path: Path) -> None:
    """The loads are not used, but a file that is cut off or shifted shows in them."""
    step, total = (_header(lines, name) for name in ("time increment in simulation", "total simulation time in file"))
    start = next((at for at, line in enumerate(lines) if line.strip().lower().startswith("!loading")), None)
    if start is None or step is None or total is None or step <= 0.0:
        raise PartFileError(path, "has no '!Loading' with time increment and total time in its heading: cut off")
    rows = [line.split() for line in lines[start + 2 :] if line.strip()]
    expected = round(total / step) + 1
    if len(rows) < expected:
        raise PartFileError(path, f"holds loads at {len(rows)} times, its heading says {expected}: cut off")
    for row in rows[:expected]:
        if not n + 1 <= len(row) <= n + 2:
            found = f"found {len(row)} numbers at time {row[0]}"
            raise PartFileError(path, f"loads: {found}, expected time, {n} forces and at most a wave elevation")
        _numbers(row, f"loads at time {row[0]}", path)


def _header(lines: list[str], name: str) -> float | None:
    for line in lines:
        if line.strip().lower().startswith(f"!{name}:"):
            try:
                found = number(line.split(":", 1)[1])
            except ValueError:
                return None
            return found if np.isfinite(found) else None
    return None


def _guyan(text: str, path: Path) -> tuple[FloatArray, FloatArray]:
    """Stiffness and mass of GuyanASCII: mass, damping, stiffness at fixed lines (3, 10, 17), six by six."""
    lines = text.splitlines()
    blocks = {}
    for title, name in ((1, "mass"), (8, "damping"), (15, "stiffness")):
        if len(lines) <= title or not lines[title].strip().lower().startswith(f"#{name}"):
            raise PartFileError(path, f"line {title + 1}: expected '#{name.capitalize()}': cut off or shifted")
        blocks[name] = _square(lines, title + 1, 6, f"{name} matrix", path)
    return blocks["stiffness"], blocks["mass"]


def _square(lines: list[str], start: int, n: int, what: str, path: Path) -> FloatArray:
    """(n, n): the numbers of n lines. Raises PartFileError naming the line."""
    rows = []
    for at in range(start, start + n):
        words = lines[at].split() if at < len(lines) else []
        if len(words) != n:
            found = f"line {at + 1}: found {len(words)} words in row {at - start + 1} of the {what}"
            raise PartFileError(path, f"{found}, expected {n} numbers: cut off or shifted")
        rows.append(_numbers(words, f"line {at + 1}", path))
    return np.array(rows)


def _numbers(words: list[str], where: str, path: Path) -> list[float]:
    """Finite numbers: one that is not would pass every comparison here."""
    try:
        numbers = [number(word) for word in words]
    except ValueError as error:
        raise PartFileError(path, f"{where}: {error}") from error
    if not np.all(np.isfinite(numbers)):
        word = words[int(np.argmin(np.isfinite(numbers)))].strip()
        raise PartFileError(path, f"{where}: found {short(word)}, expected a finite number")
    return numbers


def _subdyn(text: str, path: Path) -> SuperElement:
    """The Guyan matrices KBBt and MBBt at the transition piece of a SubDyn summary.

    Its tail is no YAML (matrices without columns), so the entries wanted are read by themselves. The summary has no
    coupling of Craig-Bampton modes, so those are left out, with a warning. Raises PartFileError when the matrices do
    not give the Guyan frequencies that the file says.
    """
    if "summary file was closed" not in text:
        raise PartFileError(path, "does not end with 'This summary file was closed': cut off")
    stiffness, mass = (_yaml_matrix(text, name, path, 6) for name in ("KBBt", "MBBt"))
    said = _yaml_matrix(text, "GY_frequencies", path, 1)[0]
    _check_frequencies(stiffness, mass, said, path)
    dropped = _yaml_matrix(text, "CB_frequencies", path, 1)[0]
    if len(dropped):
        logger.warning(
            "%s: its %d Craig-Bampton modes (from %.4g Hz) are left out: the summary has no coupling of them",
            path.name,
            len(dropped),
            dropped.min(),
        )
    found = re.search(r"^TP_point\s*:\s*\[([^\]\n]*)\]", text, re.MULTILINE)
    point = _entries(found[1], "TP_point", path) if found else np.zeros(0)
    if point.shape != (3,):
        raise PartFileError(path, "TP_point: expected the three coordinates of the transition piece")
    return _super_element(path, stiffness, mass, AXES, point)


def _check_frequencies(stiffness: FloatArray, mass: FloatArray, said: FloatArray, path: Path) -> None:
    if len(said) != len(mass):
        raise PartFileError(path, f"GY_frequencies: found {len(said)}, expected {len(mass)}")
    try:
        values = lowest_modes((mass + mass.T) / 2.0, (stiffness + stiffness.T) / 2.0, len(mass))[0]
    except np.linalg.LinAlgError as error:
        raise PartFileError(path, f"KBBt and MBBt have no frequencies ({error}): damaged") from error
    found = np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi)
    if len(found) != len(said):
        raise PartFileError(path, f"KBBt and MBBt have {len(found)} frequencies, the file says {len(said)}: damaged")
    if np.any(np.abs(found - said) > SAME_FREQUENCY * np.maximum(said, 0.01 * np.max(said))):
        pairs = ", ".join(f"{a:.5g} ({b:.5g})" for a, b in zip(found, said, strict=True))
        raise PartFileError(path, f"KBBt and MBBt give {pairs} Hz, in brackets the file's GY_frequencies: damaged")


def _yaml_matrix(text: str, name: str, path: Path, rows: int) -> FloatArray:
    """(rows, columns) of the entry ``name: # rows x columns``, one list a line."""
    head = re.search(rf"^{name}\s*:\s*#\s*(\d{{1,9}})\s*x\s*(\d{{1,9}})\b.*\n", text, re.MULTILINE)
    if head is None:
        raise PartFileError(path, f"has no entry '{name}: # rows x columns': cut off, or of another version")
    if int(head[1]) != rows or (rows > 1 and int(head[2]) != rows):
        raise PartFileError(
            path, f"{name}: is {head[1]}x{head[2]}, expected {rows} rows" + (" and columns" * (rows > 1))
        )
    found = []
    for line in text[head.end() :].splitlines()[:rows]:
        inner = re.fullmatch(r"\s*-\s*\[(.*)\]\s*", line)
        if inner is None:
            raise PartFileError(path, f"{name}: found '{short(line.strip())}', expected a list in brackets")
        found.append(_entries(inner[1], name, path))
        if len(found[-1]) != int(head[2]):
            raise PartFileError(path, f"{name}: found {len(found[-1])} numbers in a row, expected {head[2]}")
    if len(found) != rows:
        raise PartFileError(path, f"{name}: found {len(found)} rows, expected {rows}: cut off")
    return np.array(found).reshape(rows, int(head[2]))


def _entries(text: str, name: str, path: Path) -> FloatArray:
    return np.array(_numbers([word for word in text.split(",") if word.strip()], name, path))
