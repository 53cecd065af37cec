"""Condensed parts in our laboratory's text format: points, modes, then stiffness and mass, row by row."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from prs_model import PartFileError, PartRequest, Reducer, Section, SuperElement
from prs_model.part_files import MODE, LabelledMatrices, NodeTable, read_text, super_element

SIX = np.arange(6)  # ux uy uz rx ry rz


class LabTextOptions(Section):
    """What the file does not say."""

    fixed_interface: bool = True  # the modes are those with all points held, mass-normalised


class LabTextReducer(Reducer[LabTextOptions]):
    """Reads ``.lab`` files: a line per point and per mode, both matrices, and the word ``end``."""

    description = "condensed matrices in our laboratory's text format (.lab)"
    Options = LabTextOptions
    gives = "reduced"
    units = "asked"

    def read(self, part: PartRequest[LabTextOptions]) -> SuperElement:
        """Points become nodes with six coordinates each; the modes come last."""
        lines = Lines(part.path)
        points = [(name, [lines.number(word) for word in place]) for name, *place in lines.table("points", 4)]
        modes = {name: lines.number(frequency) for name, frequency in lines.table("modes", 2)}
        stiffness, mass = lines.matrix("stiffness"), lines.matrix("mass")
        lines.end()
        names = np.array([name for name, _ in points])
        matrices = LabelledMatrices(
            part.path,
            stiffness,
            mass,
            nodes=np.concatenate([np.repeat(names, len(SIX)), list(modes)]),
            components=np.concatenate([np.tile(SIX, len(names)), np.full(len(modes), MODE)]),
        )
        fixed = part.options.fixed_interface and bool(modes)
        if fixed:
            check_modes(part.path, stiffness, modes)
        table = NodeTable(part.path, names, np.array([place for _, place in points]))
        return super_element(matrices, table, part.file_units, modes="fixed-interface" if fixed else "")


def check_modes(path: Path, stiffness: np.ndarray, modes: dict[str, float]) -> None:
    """The list of modes says their frequencies, and so does the stiffness: a wrong digit in one of them is seen."""
    omega = 2.0 * np.pi * np.array(list(modes.values()))
    diagonal = np.diag(stiffness)[-len(modes) :]
    for name, listed, found in zip(modes, omega**2, diagonal, strict=True):
        if not np.isclose(listed, found, rtol=1e-5):
            raise PartFileError(path, f"mode {name}: stiffness {found:g}, expected {listed:g} of its frequency")


class Lines:
    """The lines of a file, taken one after the other. Every error names the line."""

    def __init__(self, path: Path):
        self.path = path
        self.lines = [line.split("#")[0].split() for line in read_text(path).splitlines()]
        self.at = 0

    def next(self, expected: str) -> list[str]:
        while self.at < len(self.lines):
            self.at += 1
            if self.lines[self.at - 1]:
                return self.lines[self.at - 1]
        raise self.wrong("the end of the file", expected)

    def table(self, word: str, columns: int | None = None) -> Iterator[list[str]]:
        """The rows under a heading such as ``points 2``; as many columns as rows where nothing else is said."""
        expected = f"'{word}' and the number of rows"
        heading = self.next(expected)
        if len(heading) != 2 or heading[0] != word or not heading[1].isdecimal():
            raise self.wrong(f"'{' '.join(heading)}'", expected)
        for _ in range(int(heading[1])):
            row = self.next(f"another row of '{word}'")
            if len(row) != (columns or int(heading[1])):
                raise self.wrong(f"{len(row)} columns", f"{columns or heading[1]} as in each row of '{word}'")
            yield row

    def matrix(self, word: str) -> np.ndarray:
        return np.array([[self.number(entry) for entry in row] for row in self.table(word)])

    def number(self, word: str) -> float:
        try:
            return float(word)
        except ValueError:
            raise self.wrong(f"'{word}'", "a number") from None

    def end(self) -> None:
        if self.next("'end'") != ["end"]:
            raise self.wrong(f"'{' '.join(self.lines[self.at - 1])}'", "'end'")
        if any(self.lines[self.at :]):
            raise self.wrong("lines after 'end'", "none")

    def wrong(self, found: str, expected: str) -> PartFileError:
        return PartFileError(self.path, f"line {self.at}: found {found}, expected {expected}")
