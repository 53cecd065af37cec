"""Where a joint takes hold of a body: nodes of its part by set, by label, or by place."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, Any, Literal

from pydantic import AfterValidator, Field, ValidationError, field_validator, model_validator
from pydantic_core import InitErrorDetails, PydanticCustomError

from .quantity import Length, Number, PositiveLength
from .section import Section

Point = tuple[Length, Length, Length]
NodeId = int | str
Coupling = Literal["rigid", "averaged"]
Tie = Literal["joint", "interface"]
Method = Literal["joint-loaded", "craig-bampton"]


def _wrong(message: str) -> PydanticCustomError:
    return PydanticCustomError("found", "{message}", {"message": message})


def _rising(bounds: tuple[float, float]) -> tuple[float, float]:
    if bounds[0] > bounds[1]:
        raise _wrong("found the bounds in falling order, expected [low, high]")
    return bounds


def _not_zero(direction: tuple[float, float, float]) -> tuple[float, float, float]:
    if not any(direction):
        raise _wrong("found a zero vector, expected a direction")
    return direction


def _not_empty(nodes: tuple[NodeId, ...]) -> tuple[NodeId, ...]:
    if not nodes:
        raise _wrong("found an empty list, expected node numbers")
    return nodes


def _without_dots(name: str) -> str:
    if "." in name or not name:
        raise _wrong(f"found '{name}', expected a name without dots")
    return name


Bounds = Annotated[tuple[Length, Length], AfterValidator(_rising)]
Direction = Annotated[tuple[Number, Number, Number], AfterValidator(_not_zero)]


class Box(Section):
    """An axis-aligned box in the part file's frame; an omitted axis is unbounded."""

    x: Bounds | None = None
    y: Bounds | None = None
    z: Bounds | None = None


class Cylinder(Section):
    """Nodes within `tolerance` of the surface of a cylinder of `radius` about the line through `point` along `axis`."""

    point: Point
    axis: Direction
    radius: PositiveLength
    tolerance: PositiveLength
    length: Bounds | None = None  # extent along the axis, measured from `point`


class Plane(Section):
    """Nodes within `tolerance` of the plane through `point` with this normal."""

    point: Point
    normal: Direction
    tolerance: PositiveLength


class Selection(Section):
    """Which finite-element nodes of the part belong to an interface: named one way, or several to intersect."""

    set: str | None = None
    nodes: Annotated[tuple[NodeId, ...], AfterValidator(_not_empty)] | None = None
    box: Box | None = None
    cylinder: Cylinder | None = None
    plane: Plane | None = None

    def is_empty(self) -> bool:
        return all(getattr(self, way) is None for way in Selection.model_fields)

    def alone(self) -> Selection:
        """The selection without what a Member or an Interface adds to it."""
        return Selection(**{way: getattr(self, way) for way in Selection.model_fields})


class Member(Selection):
    """One interface of a joint that has several; `name` is the one the joint uses."""

    name: Annotated[str, AfterValidator(_without_dots)]
    at: Point | None = None  # default: the (area-weighted) centre of its nodes

    @model_validator(mode="after")
    def _has_nodes(self) -> Member:
        if self.is_empty():
            raise _wrong("found no nodes, expected one or more of set, nodes, box, cylinder, plane")
        return self


class Travel(Section):
    """The interface travels along the body with a URDF joint.

    `along` is the direction of travel in the body frame. Stations are values of the joint. With ``reduced`` the body is
    reduced once per station with its contact there and its matrices are splined in between; with ``stations`` every
    station keeps its own node and the contact is read between them. That costs six coordinates a station, and wants
    averaged coupling: rigid contacts at all stations at once stiffen the whole part, wherever the contact is. `at`,
    boxes and cylinders of the interface describe the contact at joint value zero and move along with it.
    """

    joint: str
    along: tuple[Number, Number, Number]
    stations: Annotated[tuple[Number, ...], Field(min_length=4)]
    method: Literal["reduced", "stations"] = "reduced"


class Interface(Selection):
    """Where a joint takes hold of a body: one selection of nodes, or one per member.

    In short a word (a node set, or else the node of that name), a number (a node) or a list (of nodes).
    """

    named: str | None = None  # a node set of the part, or else its node of that name
    at: Point | None = None  # the condensation node in the body frame; default: centre of the nodes
    node: NodeId | None = None  # one node of the part by its name or number; default for reduced parts: this name
    members: tuple[Member, ...] = ()
    coupling: Coupling | None = None
    tie: Tie | None = None
    travel: Travel | None = None

    @model_validator(mode="before")
    @classmethod
    def _in_short(cls, raw: Any) -> Any:
        if isinstance(raw, str):
            return {"named": raw}
        if isinstance(raw, int) and not isinstance(raw, bool):
            return {"node": raw}
        return {"nodes": raw} if isinstance(raw, Sequence) else raw

    @field_validator("members")
    @classmethod
    def _with_names_of_their_own(cls, members: tuple[Member, ...]) -> tuple[Member, ...]:
        names = [member.name for member in members]
        for index, name in enumerate(names):
            if name in names[:index]:
                message = _wrong(f"found '{name}' a second time, expected a name of its own for every member")
                details = InitErrorDetails(type=message, loc=(index, "name"), input=name)
                raise ValidationError.from_exception_data("members", [details])
        return members

    @model_validator(mode="after")
    def _named_one_way(self) -> Interface:
        ways = {
            "a selection (set, nodes, box, cylinder, plane)": not self.is_empty(),
            "node": self.node is not None,
            "named": self.named is not None,
            "members": bool(self.members),
        }
        given = [way for way, present in ways.items() if present]
        if len(given) > 1:
            raise _wrong(f"found {' and '.join(given)}, expected only one of them")
        return self
