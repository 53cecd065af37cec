"""The models that are held against each other: two of complete order, and the ways to reduce a machine's parts."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ..description.schema import Coupling
from ..errors import UnknownNameError
from ..machine import Machine

MODES_PER_PART = 3  # the paper's P
CURVE = (0, 1, 2, 3, 5, 10)

COUPLINGS: Mapping[str, Coupling] = {"A": "averaged", "B": "rigid"}
TITLES = {"A": "complete order, interfaces averaged", "B": "complete order, interfaces rigid"}
_SETTINGS = ("method", "coupling", "tie", "modes")


@dataclass(frozen=True)
class Reduction:
    """One way to reduce all parts of a machine.

    own: the complete model with the same interface kinematics, whose frequencies the reduced ones cannot fall below.
    settings: entries of the `reduction` section. modes: per part; None leaves those of the machine. family: what the
    points of one curve have in common.
    """

    name: str
    title: str
    own: str
    settings: Mapping[str, str | None]
    modes: int | None = MODES_PER_PART
    family: str = ""

    def of(self, machine: Machine) -> Machine:
        """The machine with every part reduced like this, entries of single bodies included."""
        wanted = dict(self.settings) | ({} if self.modes is None else {"modes": self.modes})
        changes: dict[str, object] = {f"reduction.{key}": value for key, value in wanted.items()}
        for name, body in machine.description.file.bodies.items():
            own = [key for key in _SETTINGS if key in wanted and getattr(body, key) is not None]
            changes |= {f"bodies.{name}.{key}": wanted[key] for key in own}
        return machine.replace(changes)

    def with_modes(self, count: int) -> Reduction:
        """The same reduction with so many modes in every part, as a point of a curve."""
        return replace(self, name=f"{self.name}, P = {count}", modes=count, family=self.title)


def _craig_bampton(coupling: Coupling, tie: str) -> dict[str, str | None]:
    return {"method": "craig-bampton", "coupling": coupling, "tie": tie}


REDUCTIONS = (
    Reduction("rigid-joint", "rigid, one node a joint (the paper's)", "B", _craig_bampton("rigid", "joint")),
    Reduction("rigid-interface", "rigid, one node an interface", "B", _craig_bampton("rigid", "interface")),
    Reduction("averaged-interface", "averaged, one node an interface", "A", _craig_bampton("averaged", "interface")),
    Reduction(
        "joint-loaded",
        "shapes under the joints' springs",
        "A",
        {"method": "joint-loaded", "coupling": None, "tie": None},
        modes=None,
    ),
)
"""The four that are compared. Craig-Bampton's have the paper's three modes in every part, the joint-loaded one as many
as the machine says."""


def reductions_named(names: Sequence[str]) -> tuple[Reduction, ...]:
    """Some of the four. Raises UnknownNameError."""
    known = {each.name: each for each in REDUCTIONS}
    for name in names:
        if name not in known:
            raise UnknownNameError("reduction", name, list(known))
    return tuple(known[name] for name in dict.fromkeys(names))


def curve_of(reductions: Sequence[Reduction], modes: Sequence[int] = CURVE) -> tuple[Reduction, ...]:
    """Every reduction with 0, 1, 2 .. modes in every part: the points of the curve of error against coordinates."""
    return tuple(each.with_modes(count) for each in reductions for count in modes)


def with_joint_stiffness(machine: Machine, factor: float) -> Machine:
    """The machine with `factor` times the stiffness of every joint, its drive included."""
    joints = machine.description.file.joints
    factors = {name: factor * float(joint.stiffness_factor or 1.0) for name, joint in joints.items()}
    return machine.replace({f"joints.{name}.stiffness_factor": value for name, value in factors.items()})
