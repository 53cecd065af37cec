"""The sections of machine.yaml. Values are SI once validated; names may hold ``<limb>`` placeholders."""

from __future__ import annotations

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from .interface import Coupling as Coupling
from .interface import Interface as Interface
from .interface import Member as Member
from .interface import Method as Method
from .interface import Point as Point
from .interface import Selection as Selection
from .interface import Tie as Tie
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
    LossFactor,
    Mass,
    Number,
    PositiveLength,
    PositiveNumber,
    Rate,
    RotationalCompliance,
    RotationalStiffness,
    Source,
    Stiffness,
    StiffnessRR,
    StiffnessTR,
    StiffnessTT,
    Tolerance,
)
from .section import Section as Section
from .units import Units

AXES = ("ux", "uy", "uz", "rx", "ry", "rz")


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
    options: dict[str, Any] = Field(default_factory=dict)


class Closure(Section):
    """A loop: two URDF links or frames that coincide (``frame``, 6 rows) or whose origins do (``point``, 3 rows)."""

    between: tuple[str, str]
    kind: Literal["frame", "point"] = "frame"
    per: str | None = None


# ── bodies ───────────────────────────────────────────────────────────────────────────────────────────


class Expected(Section):
    """What is known of a part beforehand; one that differs by more than the tolerance is refused.

    mass: of a free part. frequency [Hz]: the first of the reduced part, held nowhere but where its file holds it.
    """

    mass: Mass | None = None
    frequency: Frequency | None = None
    tolerance: Tolerance | None = None  # relative; default 0.05


class Body(Section):
    """One part: the URDF link that carries it, how it is read, and where it is held.

    `options` are the reducer's; as written in the file, validated and in SI in a MachineDescription.
    """

    frame: str
    reducer: str
    source: str | None = None
    units: str | None = None  # of the part file, such as mm-N-tonne-s
    options: dict[str, Any] = Field(default_factory=dict)
    interfaces: dict[str, Interface] = Field(default_factory=dict)
    clamped: tuple[str, ...] = ()  # node sets of the part file held to the ground before reduction
    grounded: bool = False
    expected: Expected | None = None
    method: Method | None = None
    modes: Annotated[int, Field(ge=0)] | None = None
    coupling: Coupling | None = None
    tie: Tie | None = None
    per: str | None = None


class ReductionDefaults(Section):
    """What bodies use that do not say otherwise. Coupling and tie follow from the method when they are left out."""

    method: Method = "joint-loaded"
    coupling: Coupling | None = None
    tie: Tie | None = None
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
    stiffness_factor: PositiveNumber | None = None  # on all of its stiffness, the drive's included; default 1
    per: str | None = None


# ── the whole ────────────────────────────────────────────────────────────────────────────────────────


class Rayleigh(Section):
    """C = alpha M + beta K, alpha in 1/s, beta in s."""

    alpha: Rate
    beta: Duration


class JointDamping(Section):
    """A joint of stiffness K_j damps: C_j = viscous K_j [s], or K_j (1 + j loss_factor) at any frequency; both add."""

    viscous: Duration | None = None
    loss_factor: LossFactor | None = None


def _one_or_several(raw: Any) -> str:
    return "several" if isinstance(raw, list | tuple) else "one"


ModalRatios = Annotated[
    Annotated[DampingRatio, Tag("one")] | Annotated[tuple[DampingRatio, ...], Field(min_length=1), Tag("several")],
    Discriminator(_one_or_several),
]


class Damping(Section):
    """Damping ratios of the modes, or Rayleigh's two constants; and what joints add to that.

    modal: one ratio for all modes, or one for each that is not rigid; further modes have the last one. joints: by their
    names, or by those of their instances.
    """

    modal: ModalRatios | None = None
    rayleigh: Rayleigh | None = None
    joints: dict[str, JointDamping] = Field(default_factory=dict)


class PublishedShare(Section):
    """What a mode, counted from 1, gives to the static compliance of the end-reference point, as a share of it."""

    mode: Annotated[int, Field(ge=1)]
    share: Annotated[float, Field(ge=0.0, le=1.0)]


class Verification(Section):
    """Where ``prs-model verify`` holds reduced models against the complete order, and what others have found.

    poses: besides the reference, every combination of these values, in the units of the file; coordinates left out
    stand at their reference. published [Hz]: frequencies at the reference pose by where they come from. shares: there
    too, of the compliance along an axis. note: why the model differs from what is published, in a sentence or two.
    """

    poses: dict[str, tuple[Number, ...]] = Field(default_factory=dict)
    published: dict[str, tuple[Frequency, ...]] = Field(default_factory=dict)
    shares: dict[str, dict[Literal["u", "v", "w"], PublishedShare]] = Field(default_factory=dict)
    note: str = ""


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
    symmetry: dict[str, tuple[int | str, ...]] = Field(default_factory=dict)
    task: Task
    closures: dict[str, Closure] = Field(default_factory=dict)
    reduction: ReductionDefaults = ReductionDefaults()
    bodies: dict[str, Body]
    joints: dict[str, Joint]
    damping: Damping = Damping()
    output: Output
    verification: Verification | None = None
