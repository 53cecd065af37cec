"""The sections of machine.yaml. Values are SI once validated; names may hold ``<limb>`` placeholders."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import BaseModel, ConfigDict, Discriminator, Field, Tag

from .quantity import (
    AxisRotationalStiffness,
    AxisStiffness,
    Compliance,
    ComplianceRR,
    ComplianceTR,
    ComplianceTT,
    DampingRatio,
    Duration,
    Force,
    Frequency,
    Length,
    Mass,
    Number,
    PositiveLength,
    Rate,
    RotationalCompliance,
    RotationalStiffness,
    Source,
    Stiffness,
    StiffnessRR,
    StiffnessTR,
    StiffnessTT,
)
from .units import Units

AXES = ("ux", "uy", "uz", "rx", "ry", "rz")

Point = tuple[Length, Length, Length]
NodeId = int | str


class Section(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)


# ── task and closures ────────────────────────────────────────────────────────────────────────────────


class Reference(Section):
    """The configuration from which Newton starts. A joint's name may hold a placeholder: ``slide_<limb>: 650``.

    Lengths and angles are in the units of the file; MachineDescription has them in SI.
    """

    pose: dict[str, Number]
    joints: dict[str, Number]


class Task(Section):
    """What a pose of this machine is: the plug-in, the frame it moves, the workspace."""

    kind: str
    frame: str
    relative_to: str | None = None  # default: the root link
    workspace: dict[str, tuple[Number, Number]]
    reference: Reference
    options: dict[str, Any] = {}


class Closure(Section):
    """A loop: two URDF links or frames that coincide (``frame``, 6 rows) or whose origins do (``point``, 3 rows)."""

    between: tuple[str, str]
    kind: Literal["frame", "point"] = "frame"
    per: str | None = None


# ── bodies ───────────────────────────────────────────────────────────────────────────────────────────

Coupling = Literal["rigid", "averaged"]
Tie = Literal["joint", "interface"]


class Box(Section):
    """An axis-aligned box in the part file's frame; an omitted axis is unbounded."""

    x: tuple[Length, Length] | None = None
    y: tuple[Length, Length] | None = None
    z: tuple[Length, Length] | None = None


class Cylinder(Section):
    """Nodes within `tolerance` of the surface of a cylinder of `radius` about the line through `point` along `axis`."""

    point: Point
    axis: tuple[Number, Number, Number]
    radius: PositiveLength
    tolerance: PositiveLength
    length: tuple[Length, Length] | None = None  # extent along the axis, measured from `point`


class Plane(Section):
    """Nodes within `tolerance` of the plane through `point` with this normal."""

    point: Point
    normal: tuple[Number, Number, Number]
    tolerance: PositiveLength


class Selection(Section):
    """Which finite-element nodes of the part belong to an interface: named one way, or several to intersect."""

    set: str | None = None
    nodes: tuple[NodeId, ...] | None = None
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

    name: str
    at: Point | None = None  # default: the (area-weighted) centre of its nodes


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
    """Where a joint takes hold of a body: one selection of nodes, or one per member."""

    at: Point | None = None  # the condensation node in the body frame; default: centre of the nodes
    node: NodeId | None = None  # one node of the part by its name or number; default for reduced parts: this name
    members: tuple[Member, ...] = ()
    coupling: Coupling | None = None
    tie: Tie | None = None
    travel: Travel | None = None


class Expected(Section):
    """What is known of a part beforehand; one that differs by more than the tolerance is refused.

    mass: of a free part. frequency [Hz]: the first of the reduced part, held nowhere but where its file holds it.
    """

    mass: Mass | None = None
    frequency: Frequency | None = None
    tolerance: DampingRatio | None = None  # relative; default 0.05


class Body(Section):
    """One part: the URDF link that carries it, how it is read, and where it is held.

    `options` are the reducer's; as written in the file, validated and in SI in a MachineDescription.
    """

    frame: str
    reducer: str
    source: str | None = None
    units: str | None = None  # of the part file, such as mm-N-tonne-s
    options: dict[str, Any] = {}
    interfaces: dict[str, Interface] = {}
    clamped: tuple[str, ...] = ()  # node sets of the part file held to the ground before reduction
    grounded: bool = False
    expected: Expected | None = None
    modes: Annotated[int, Field(ge=0)] | None = None
    coupling: Coupling | None = None
    tie: Tie | None = None
    per: str | None = None


class ReductionDefaults(Section):
    """What bodies use that do not say otherwise."""

    coupling: Coupling = "rigid"
    tie: Tie = "joint"
    modes: Annotated[int, Field(ge=0)] = 3
    store: str | None = None  # folder of stored super-elements, beside machine.yaml


# ── joints ───────────────────────────────────────────────────────────────────────────────────────────


class DiagonalStiffness(Section):
    """Stiffness along and about the axes of the joint frame; rotations per radian. Free axes are left out;
    zero means that nothing is transmitted (a floating bearing)."""

    ux: AxisStiffness | None = None
    uy: AxisStiffness | None = None
    uz: AxisStiffness | None = None
    rx: AxisRotationalStiffness | None = None
    ry: AxisRotationalStiffness | None = None
    rz: AxisRotationalStiffness | None = None
    source: Source | None = None
    note: str | None = None


class DiagonalCompliance(Section):
    """Compliance along and about the axes of the joint frame; zero is rigid. Free axes are left out."""

    ux: Compliance | None = None
    uy: Compliance | None = None
    uz: Compliance | None = None
    rx: RotationalCompliance | None = None
    ry: RotationalCompliance | None = None
    rz: RotationalCompliance | None = None
    source: Source | None = None
    note: str | None = None


_StiffnessTop = tuple[StiffnessTT, StiffnessTT, StiffnessTT, StiffnessTR, StiffnessTR, StiffnessTR]
_StiffnessBottom = tuple[StiffnessTR, StiffnessTR, StiffnessTR, StiffnessRR, StiffnessRR, StiffnessRR]
StiffnessMatrix = tuple[
    _StiffnessTop, _StiffnessTop, _StiffnessTop, _StiffnessBottom, _StiffnessBottom, _StiffnessBottom
]
_ComplianceTop = tuple[ComplianceTT, ComplianceTT, ComplianceTT, ComplianceTR, ComplianceTR, ComplianceTR]
_ComplianceBottom = tuple[ComplianceTR, ComplianceTR, ComplianceTR, ComplianceRR, ComplianceRR, ComplianceRR]
ComplianceMatrix = tuple[
    _ComplianceTop, _ComplianceTop, _ComplianceTop, _ComplianceBottom, _ComplianceBottom, _ComplianceBottom
]


def _axes_or_matrix(raw: Any) -> str:
    return "matrix" if isinstance(raw, list | tuple) else "axes"


StiffnessLaw = Annotated[
    Annotated[DiagonalStiffness, Tag("axes")] | Annotated[StiffnessMatrix, Tag("matrix")],
    Discriminator(_axes_or_matrix),
]
ComplianceLaw = Annotated[
    Annotated[DiagonalCompliance, Tag("axes")] | Annotated[ComplianceMatrix, Tag("matrix")],
    Discriminator(_axes_or_matrix),
]


class ElasticLaw(Section):
    """How two coinciding points hold each other: a stiffness, a compliance, or rigidly. One of the three."""

    stiffness: StiffnessLaw | None = None
    compliance: ComplianceLaw | None = None
    rigid: bool = False


class JointInterface(ElasticLaw):
    """One of the interfaces that act in parallel, placed in the joint frame (axes parallel to it)."""

    name: str | None = None
    at: Point | None = None  # default: the joint's origin


class ConstantDrive(Section):
    """A drive of constant stiffness along (prismatic) or about (revolute) the free axis; one of the two."""

    kind: Literal["constant"]
    stiffness: Stiffness | None = None
    rotational_stiffness: RotationalStiffness | None = None
    at: Point | None = None


class BallScrew(Section):
    """Nut in series with a screw held at both ends (Table 2 of the paper), or at the front only: no `rear_bearing`."""

    kind: Literal["ball_screw"]
    nut: Stiffness
    front_bearing: Stiffness
    rear_bearing: Stiffness | None = None
    EA: Force
    length: PositiveLength
    origin: Length  # joint value at which the nut stands at the front bearing
    at: Point | None = None


Drive = Annotated[ConstantDrive | BallScrew, Field(discriminator="kind")]


class Stage(ElasticLaw):
    """Interfaces in parallel on one URDF joint (or on a fixed frame), with a drive where the joint is actuated."""

    urdf: str | None = None
    frame: str | None = None
    interfaces: tuple[JointInterface, ...] = ()
    drive: Drive | None = None


class Joint(Stage):
    """An elastic joint between two body interfaces, ``body.interface`` or ``ground``; stages act in series."""

    between: tuple[str, str]
    stages: tuple[Stage, ...] = ()
    as_printed: bool = False
    per: str | None = None


# ── the whole ────────────────────────────────────────────────────────────────────────────────────────


class Rayleigh(Section):
    """C = alpha M + beta K, alpha in 1/s, beta in s."""

    alpha: Rate
    beta: Duration


class Damping(Section):
    """One modal damping ratio for all modes, or Rayleigh's two constants."""

    modal: DampingRatio | None = None
    rayleigh: Rayleigh | None = None


class Output(Section):
    """The end-reference point: a node, and the URDF frame whose axes its motion is measured in."""

    node: str
    frame: str


class MachineFile(Section):
    """One machine.yaml."""

    name: str
    title: str = ""
    urdf: str
    units: Units = Units()
    symmetry: dict[str, tuple[int | str, ...]] = {}
    task: Task
    closures: dict[str, Closure] = {}
    reduction: ReductionDefaults = ReductionDefaults()
    bodies: dict[str, Body]
    joints: dict[str, Joint]
    damping: Damping = Damping()
    output: Output
