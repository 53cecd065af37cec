"""The numbers behind the page as CSV, a header line with units first, and all of them as JSON."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..errors import PrsError
from ..modes.mac import mac
from ..reduction.storage import whole
from ..reduction.super_element import AXES
from ..response.files import write_csv
from ..response.quantity import DIRECTIONS, unit

if TYPE_CHECKING:
    from .card import Joint, Part
    from .sources import Entry
    from .study import AtRest, Study

Rows = Iterable[Sequence[object]]


def write_tables(study: Study, first: Study, folder: Path) -> tuple[str, ...]:
    """Write the tables of a pose into a folder; their names. first: the pose that shapes are compared with."""
    modes = study.modes
    tables: dict[str, Rows] = {
        "modes.csv": _modes(study),
        "kinetic_energy.csv": _by_mode("body", modes.kinetic_energy()),
        "strain_energy.csv": _by_mode("body or joint", modes.strain_energy()),
        "joint_strain_energy.csv": _by_axis(study),
        "mac.csv": [["mode of the first pose", *_numbers(study)], *_numbered(mac(first.modes, modes).tolist())],
    }
    if study.at_rest is not None:
        tables["compliance.csv"] = _compliance(study.at_rest)
        tables["flexibility.csv"] = _flexibility(study.at_rest)
    for name, rows in tables.items():
        write_text(folder / name, csv_text(rows))
    if study.response is None:
        return tuple(tables)
    write_csv(study.response, folder / "frf.csv", [(row, column) for row in DIRECTIONS for column in DIRECTIONS])
    return (*tables, "frf.csv")


def write_card(
    parts: Sequence[Part], joints: Sequence[Joint], entries: Sequence[Entry], folder: Path
) -> tuple[str, ...]:
    """Write parts.csv, joints.csv and sources.csv; their names."""
    tables: dict[str, Rows] = {
        "parts.csv": [
            ["part", "number", "mass of one [kg]", "reducer", "source", "coordinates", "full DOFs", "checks passed"],
            *(
                [p.name, p.number, _mass(p), p.reducer, p.source, p.figures.coordinates, p.full_dofs, len(p.checks)]
                for p in parts
            ),
        ],
        "joints.csv": [["joint", "number", "between", "law"], *([j.name, j.number, j.between, j.law] for j in joints)],
        "sources.csv": [["entry", "value", "unit", "source", "note"], *(list(asdict(e).values()) for e in entries)],
    }
    for name, rows in tables.items():
        write_text(folder / name, csv_text(rows))
    return tuple(tables)


def as_dict(study: Study) -> dict[str, Any]:
    """Everything of a pose but its frequency response, in SI, for JSON."""
    modes, rest = study.modes, study.at_rest
    return {
        "pose": {name: float(value) for name, value in study.pose.items()},
        "frequencies_hz": modes.frequencies.tolist(),
        "damping_ratios": None if study.ratios is None else _ratios(study),
        "characters": [str(each) for each in modes.characters()],
        "kinetic_energy": {name: share.tolist() for name, share in modes.kinetic_energy().items()},
        "strain_energy": {name: share.tolist() for name, share in modes.strain_energy().items()},
        "joint_strain_energy": {name: each.T.tolist() for name, each in modes.joint_strain_by_direction().items()},
        "static_compliance": None if rest is None else rest.compliance.tolist(),
        "modal_flexibility": None if rest is None else rest.flexibility.tolist(),
        "flexibility_shares": None if rest is None else rest.shares.tolist(),
        "weak_modes": [] if rest is None else [str(each) for each in rest.weak],
    }


def csv_text(rows: Rows) -> str:
    """Rows as CSV."""
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()


def write_text(path: Path, text: str) -> None:
    """Write a file whole, or not at all. Raises PrsError."""
    write_bytes(path, text.encode())


def write_bytes(path: Path, content: bytes) -> None:
    """Write a file whole, or not at all. Raises PrsError."""
    try:
        with whole(path) as file:
            file.write(content)
    except OSError as error:
        raise PrsError(f"{path}: cannot be written ({error.strerror or error})") from error


def _modes(study: Study) -> Rows:
    ratios = _ratios(study)
    yield ["mode", "frequency [Hz]", "damping ratio", "what moves", "tool point"]
    for k, each in enumerate(study.modes.characters()):
        yield [k + 1, float(study.modes.frequencies[k]), ratios[k], str(each), each.output]


def _ratios(study: Study) -> list[float | None]:
    """Damping ratios, none of rigid-body modes and where joints damp."""
    known = [np.nan] * len(study.modes.frequencies) if study.ratios is None else study.ratios.tolist()
    return [None if np.isnan(each) else each for each in known]


def _by_axis(study: Study) -> Rows:
    yield ["joint", "axis", *_numbers(study)]
    for name, shares in study.modes.joint_strain_by_direction().items():
        for axis, row in zip(AXES, shares.tolist(), strict=True):
            yield [name, axis, *row]


def _compliance(rest: AtRest) -> Rows:
    yield ["motion", *(f"by a load along or about {each}" for each in DIRECTIONS), "unit by a force", "by a moment"]
    for each, row in zip(DIRECTIONS, rest.compliance.tolist(), strict=True):
        yield [each, *row, unit(each, "u"), unit(each, "ru")]


def _flexibility(rest: AtRest) -> Rows:
    yield ["mode", *(f"{each} [{unit(each, each)}]" for each in DIRECTIONS), *(f"share {each}" for each in DIRECTIONS)]
    yield from _numbered(np.hstack([rest.flexibility, rest.shares]).tolist())


def _by_mode(what: str, shares: dict[str, Any]) -> Rows:
    count = len(next(iter(shares.values())))
    yield [what, *(f"mode {k + 1}" for k in range(count))]
    for name, share in shares.items():
        yield [name, *share.tolist()]


def _numbers(study: Study) -> list[str]:
    return [f"mode {k + 1}" for k in range(len(study.modes.frequencies))]


def _numbered(rows: list[list[float]]) -> Rows:
    return [[k, *row] for k, row in enumerate(rows, start=1)]


def _mass(part: Part) -> object:
    return "" if part.figures.properties is None else part.figures.properties.mass
