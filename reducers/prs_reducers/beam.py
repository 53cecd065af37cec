"""Spatial frames of Timoshenko beams from nodes, members and sections: matrix structural analysis."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field, model_validator
from scipy.sparse import coo_array, csr_array

from prs_model.arrays import FloatArray, IntArray
from prs_model.description.problems import Place
from prs_model.description.schema import Point, Section
from prs_model.finite_elements import FiniteElementModel
from prs_model.plugins import PartRequest, Reducer
from prs_model.readable import figure

from .elements.beam_element import at_nodes, beam_matrices
from .elements.beam_sections import BeamSection, CrossSection, may_taper, tapered
from .elements.named_points import Direction, PointMass, check_ends, check_known, check_one_piece, local_axes, refuse

WIDE = 3.0  # radius of gyration per length: a thin disc has 0.25 of its diameter

_log = logging.getLogger("prs_model")


class BeamMember(Section):
    """A straight beam between two nodes, its section's z axis towards `up` (default: the body's z, or x along z).

    taper_to: the section at its far end; dimensions change linearly, and each element has those of its middle.
    offsets: from each node to where the beam ends, in body axes; what lies between is rigid. elements: equally long.
    """

    between: tuple[str, str]
    section: str
    taper_to: str | None = None
    up: Direction | None = None
    offsets: tuple[Point, Point] | None = None
    elements: Annotated[int, Field(ge=1, le=1000)] = 8
    name: str | None = None  # default: its nodes', such as 'root-tip'

    @property
    def label(self) -> str:
        return self.name or "-".join(self.between)

    def offset_vectors(self) -> FloatArray:
        """(2, 3) [m]."""
        return np.zeros((2, 3)) if self.offsets is None else np.array(self.offsets, dtype=float)


class BeamOptions(Section):
    """A frame: named nodes in the body frame, sections, the members between nodes, and masses fixed to nodes."""

    nodes: Annotated[dict[str, Point], Field(min_length=2)]
    sections: dict[str, BeamSection]
    members: tuple[BeamMember, ...]
    masses: dict[str, PointMass] = Field(default={})

    @model_validator(mode="after")
    def _is_one_frame(self) -> BeamOptions:
        check_known(("masses",), "a node", self.masses, self.nodes)
        labels = [member.label for member in self.members]
        for index, member in enumerate(self.members):
            place: Place = ("members", index)
            check_ends(place, member.between, self.nodes)
            sections = [member.section, member.taper_to or member.section]
            check_known((*place, "section"), "a section", sections, self.sections)
            if not may_taper(self.sections[sections[0]], self.sections[sections[-1]]):
                text = f"found {sections[0]} and {sections[1]}, expected sections of one kind and material"
                raise refuse((*place, "taper_to"), text)
            if labels.count(member.label) > 1:
                raise refuse(place, f"found two members '{member.label}', expected a 'name' of its own for each")
            self._check_line(place, member)
            self._check_names(member.label)
        check_one_piece(list(self.nodes), [member.between for member in self.members], "members")
        return self

    def _check_names(self, label: str) -> None:
        for name in self.nodes:
            if name.startswith(f"{label}."):
                raise refuse(
                    ("nodes", name), f"found a name like those of the inner nodes of member '{label}'; change it"
                )

    def _check_line(self, place: Place, member: BeamMember) -> None:
        start, end = self.ends(member)
        size = max(np.ptp(np.array(list(self.nodes.values()), dtype=float), axis=0))
        if not np.linalg.norm(end - start) > 1e-9 * size:
            raise refuse(place, f"found a length of zero from {member.between[0]} to {member.between[1]}")
        try:
            local_axes(end - start, member.up)
        except ValueError as error:
            raise refuse((*place, "up"), str(error)) from error

    def ends(self, member: BeamMember) -> FloatArray:
        """(2, 3): where a member's beam begins and ends [m]."""
        return np.array([self.nodes[node] for node in member.between], dtype=float) + member.offset_vectors()


class BeamReducer(Reducer[BeamOptions]):
    description: ClassVar[str] = "frame of Timoshenko beams from nodes, sections and members (no file)"
    Options: ClassVar[type[Section]] = BeamOptions
    needs_source = False
    gives = "full"

    def read(self, part: PartRequest[BeamOptions]) -> FiniteElementModel:
        """Assemble the frame. Its nodes keep their names; each member is a node set under its own.

        A warning tells of a section that is far wider than the frame is long.
        """
        _warn_of_wide_sections(part.name, part.options)
        return beam_model(part.options)


def _warn_of_wide_sections(name: str, options: BeamOptions) -> None:
    lengths = [np.linalg.norm(np.diff(options.ends(member), axis=0)) for member in options.members]
    longest = float(max([*lengths, *np.ptp(np.array(list(options.nodes.values()), dtype=float), axis=0)], default=0.0))
    for section, shape in options.sections.items():
        radius = shape.properties().radius
        if radius > WIDE * longest:
            found = f"section '{section}' has a radius of gyration of {figure(radius)} m"
            _log.warning("%s: %s, the frame is %s m long; check units", name, found, figure(longest))


@dataclass(frozen=True, eq=False)
class _Line:
    """A member's nodes in order, inner ones included: indices (m + 1,), their places (m + 1, 3) [m]."""

    member: BeamMember
    nodes: IntArray
    places: FloatArray


def beam_model(options: BeamOptions) -> FiniteElementModel:
    """The finite-element model of a frame, six degrees of freedom a node."""
    lines = list(_lines(options))
    names = [*options.nodes, *(f"{line.member.label}.{i}" for line in lines for i in range(1, line.member.elements))]
    coordinates = np.array(list(options.nodes.values()), dtype=float)
    coordinates = np.vstack([coordinates, *(line.places[1:-1] for line in lines)])
    stiffness, mass = _assembled(options, lines, 6 * len(names))
    nodes = np.arange(len(names))
    return FiniteElementModel(
        stiffness=stiffness,
        mass=mass,
        coordinates=coordinates,
        dofs=np.column_stack([np.repeat(nodes, 6), np.tile(np.arange(6), len(names))]),
        node_ids=np.array(names),
        node_sets={line.member.label: line.nodes for line in lines},
        provenance={"elements": f"{sum(line.member.elements for line in lines)} Timoshenko beams"},
    )


def _lines(options: BeamOptions) -> Iterator[_Line]:
    place = {name: index for index, name in enumerate(options.nodes)}
    free = len(place)
    for member in options.members:
        share = np.linspace(0.0, 1.0, member.elements + 1)[:, None]
        start, end = options.ends(member)
        inner = np.arange(free, free + member.elements - 1)
        free += len(inner)
        first, last = (place[node] for node in member.between)
        yield _Line(member, np.array([first, *inner, last]), (1.0 - share) * start + share * end)


def _assembled(options: BeamOptions, lines: list[_Line], size: int) -> tuple[csr_array, csr_array]:
    rows, K, M = [np.zeros((0, 12), dtype=np.int64)], [np.zeros((0, 12, 12))], [np.zeros((0, 12, 12))]
    for line in lines:
        k, m = _member_matrices(options, line)
        ends = np.stack([line.nodes[:-1], line.nodes[1:]], axis=1)
        rows.append((6 * ends[..., None] + np.arange(6)).reshape(-1, 12))
        K.append(k)
        M.append(m)
    stiffness = _scattered(np.concatenate(K), np.concatenate(rows), size)
    mass = _scattered(np.concatenate(M), np.concatenate(rows), size)
    if options.masses:
        place = {name: index for index, name in enumerate(options.nodes)}
        points = np.array([6 * place[name] + np.arange(6) for name in options.masses])
        lumps = [each.matrix(np.array(options.nodes[name], dtype=float)) for name, each in options.masses.items()]
        mass = csr_array(mass + _scattered(np.array(lumps), points, size))
    return stiffness, mass


def _member_matrices(options: BeamOptions, line: _Line) -> tuple[FloatArray, FloatArray]:
    """(m, 12, 12) twice: K and M of a member's elements in the motions of their nodes."""
    member, count = line.member, line.member.elements
    start, end = line.places[0], line.places[-1]
    axes, length = local_axes(end - start, member.up), float(np.linalg.norm(end - start)) / count
    K, M = np.zeros((count, 12, 12)), np.zeros((count, 12, 12))
    ends = member.offset_vectors()
    for index in range(count):
        offsets = np.array([ends[0] if index == 0 else np.zeros(3), ends[1] if index == count - 1 else np.zeros(3)])
        T = at_nodes(axes, offsets)
        k, m = beam_matrices(_section(options, member, (index + 0.5) / count), length)
        K[index], M[index] = T.T @ k @ T, T.T @ m @ T
    return K, M


def _section(options: BeamOptions, member: BeamMember, share: float) -> CrossSection:
    return tapered(options.sections[member.section], options.sections[member.taper_to or member.section], share)


def _scattered(blocks: FloatArray, rows: IntArray, size: int) -> csr_array:
    width = rows.shape[1]
    place = (np.repeat(rows, width, axis=1).ravel(), np.tile(rows, (1, width)).ravel())
    return csr_array(coo_array((blocks.ravel(), place), shape=(size, size)))
