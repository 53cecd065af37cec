"""The numbers behind the page as CSV, a header line with units first, and all of them as JSON."""

from __future__ import annotations

import csv
import io
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..description.units import SI, Dimension
from ..errors import PrsError
from ..modes.mac import mac
from ..reduction.storage import whole
from ..reduction.super_element import AXES
from ..response.files import write_csv
from ..response.quantity import DIRECTIONS, unit

if TYPE_CHECKING:
    from ..modes.energy import Energies
    from .card import Joint, Part
    from .sources import Entry
    from .study import AtRest, Study

Rows = Iterable[Sequence[object]]

_AXES = tuple((each[-1], len(each) > 1) for each in DIRECTIONS)


def write_tables(study: Study, first: Study, folder: Path) -> tuple[str, ...]:
    """Write the tables of a pose into a folder; their names. first: the pose that shapes are compared with."""
    likeness = [["mode of the first pose", *_columns(study, "MAC with mode")], *_numbered(_mac(first, study))]
    tables: dict[str, Rows] = {
        "modes.csv": _modes(study),
        "kinetic_energy.csv": _energies(study, "body", "kinetic", study.kinetic),
        "strain_energy.csv": _energies(study, "body or joint", "strain", study.strain),
        "joint_strain_energy.csv": _by_axis(study),
        "mac.csv": likeness,
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
    """Everything of a pose but its frequency response, in the units of `units_of`, for JSON."""
    modes, rest = study.modes, study.at_rest
    return {
        "pose": {name: float(value) for name, value in study.pose.items()},
        "frequencies_hz": modes.frequencies.tolist(),
        "damping": study.damping.model_dump(mode="json", exclude_none=True),
        "damping_ratios": None if study.ratios is None else _ratios(study),
        "characters": [str(each) for each in study.characters],
        "kinetic_energy": {name: share.tolist() for name, share in study.kinetic.items()},
        "strain_energy": {name: share.tolist() for name, share in study.strain.items()},
        "joint_strain_energy": {name: each.T.tolist() for name, each in study.joint_strain.items()},
        "static_compliance": None if rest is None else rest.compliance.tolist(),
        "modal_flexibility": None if rest is None else rest.flexibility.tolist(),
        "flexibility_shares": None if rest is None else rest.shares.tolist(),
        "weak_modes": [] if rest is None else [str(each) for each in rest.weak],
    }


def units_of(coordinates: Mapping[str, Dimension]) -> dict[str, Any]:
    """The units of `as_dict`, by its entries; what is a share has none."""
    return {
        "pose": {name: kind.label(SI) for name, kind in coordinates.items()},
        "directions": list(DIRECTIONS),
        "damping": {"rayleigh": {"alpha": "1/s", "beta": "s"}, "joints": {"viscous": "s"}},
        "static_compliance": [[unit(row, column) for column in DIRECTIONS] for row in DIRECTIONS],
        "modal_flexibility": [unit(each, each) for each in DIRECTIONS],
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
    yield ["mode", "frequency [Hz]", "damping ratio [-]", "what moves", "tool point"]
    for k, each in enumerate(study.characters):
        yield [k + 1, float(study.modes.frequencies[k]), ratios[k], str(each), each.output]


def _ratios(study: Study) -> list[float | None]:
    """Damping ratios, none of rigid-body modes and where joints damp."""
    known = [np.nan] * len(study.modes.frequencies) if study.ratios is None else study.ratios.tolist()
    return [None if np.isnan(each) else each for each in known]


def _energies(study: Study, what: str, kind: str, shares: Energies) -> Rows:
    yield [what, *_columns(study, f"share of {kind} energy in mode")]
    for name, share in shares.items():
        yield [name, *share.tolist()]


def _by_axis(study: Study) -> Rows:
    yield ["joint", "axis of its frame", *_columns(study, "share of strain energy in mode")]
    for name, shares in study.joint_strain.items():
        for axis, row in zip(AXES, shares.tolist(), strict=True):
            yield [name, axis, *row]


def _compliance(rest: AtRest) -> Rows:
    """Motions in rows, loads in columns, with their units."""
    loads = [
        f"by moment about {axis} [per N m]" if about else f"by force along {axis} [per N]" for axis, about in _AXES
    ]
    yield ["motion", *loads]
    for (axis, about), row in zip(_AXES, rest.compliance.tolist(), strict=True):
        yield [f"about {axis} [rad]" if about else f"along {axis} [m]", *row]


def _flexibility(rest: AtRest) -> Rows:
    shares = [f"share of the compliance {each} [-]" for each in DIRECTIONS]
    yield ["mode", *(f"{each} [{unit(each, each)}]" for each in DIRECTIONS), *shares]
    yield from _numbered(np.hstack([rest.flexibility, rest.shares]).tolist())


def _mac(first: Study, study: Study) -> list[list[float]]:
    found: list[list[float]] = mac(first.modes, study.modes).tolist()
    return found


def _columns(study: Study, what: str) -> list[str]:
    """A heading for each mode, of numbers without unit."""
    return [f"{what} {k + 1} [-]" for k in range(len(study.modes.frequencies))]


def _numbered(rows: list[list[float]]) -> Rows:
    return [[k, *row] for k, row in enumerate(rows, start=1)]


def _mass(part: Part) -> object:
    return "" if part.figures.properties is None else part.figures.properties.mass
