"""The character of a mode in words: which bodies move, along or about what, in phase or not."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from ..arrays import BoolArray, FloatArray
from ..synthesis.system import System

_OUTPUT_AXES = ("along u", "along v", "along w", "about u", "about v", "about w")
_OWN_AXES = tuple(f"{word} their {axis}" for word in ("along", "about") for axis in "xyz")
_RIGID_SHARE = 0.5
_NAMED_SHARE = 0.1
_MOVING_SHARE = 0.25


@dataclass(frozen=True)
class Character:
    """The group of like bodies with most kinetic energy, how it moves, and the kinetic share of each group.

    `output` is the motion of the end-reference point: along or about which axes u, v, w of the output frame.
    """

    group: str
    motion: str
    shares: Mapping[str, float]
    output: str

    def __str__(self) -> str:
        others = [f"{name} {share:.0%}" for name, share in self.shares.items() if name != self.group]
        return f"{self.group} {self.motion} ({self.shares[self.group]:.0%})" + "".join(f", {o}" for o in others)


def characters(system: System, shapes: FloatArray) -> tuple[Character, ...]:
    """One Character for each column of `shapes` (n, k)."""
    groups: dict[str, list[str]] = {}
    for body in system.elements:
        groups.setdefault(system.stems.get(body, body), []).append(body)
    motions = {body: _body_motion(system, body, shapes) for body in system.elements}
    output = _output_motion(system, shapes)
    return tuple(_character(system, groups, motions, output[:, k], k) for k in range(shapes.shape[1]))


def shares_by_group(energy: Mapping[str, float], stems: Mapping[str, str]) -> dict[str, float]:
    """Shares of the total, like bodies and joints together (`stems` name their groups), the largest first.

    Those above a tenth, and the largest in any case; none when there is no energy.
    """
    groups: dict[str, float] = {}
    for name, part in energy.items():
        group = stems.get(name, name)
        groups[group] = groups.get(group, 0.0) + part
    total = sum(groups.values())
    if total <= 0.0:
        return {}
    ranked = sorted(groups, key=lambda group: -groups[group])
    return {
        group: groups[group] / total for group in ranked if group == ranked[0] or groups[group] > _NAMED_SHARE * total
    }


@dataclass(frozen=True)
class _BodyMotion:
    """Twice the kinetic energy (k,) of a body in each mode, and its signed square root (6, k) in each rigid motion
    about the mass centre, along the axes of the output frame and of the body."""

    energy: FloatArray
    output: FloatArray
    own: FloatArray

    def is_rigid(self, mode: int) -> bool:
        return float((self.own[:, mode] ** 2).sum()) >= _RIGID_SHARE * float(self.energy[mode])


def _output_motion(system: System, shapes: FloatArray) -> FloatArray:
    """(6, k): motion of the end-reference point, rotations times the gyration radius of the body it belongs to."""
    element = system.elements[system.output_body]
    if element.grounded:
        return system.output @ shapes
    mass = element.mass_properties()
    radius = np.sqrt(np.trace(mass.inertia) / 2.0 / mass.mass)
    return np.asarray(np.array([1.0, 1.0, 1.0, radius, radius, radius])[:, None] * (system.output @ shapes))


def _body_motion(system: System, body: str, shapes: FloatArray) -> _BodyMotion:
    element = system.elements[body]
    u = system.expansion[system.blocks[body]] @ shapes
    momentum = element.mass @ u
    energy = np.einsum("ik,ik->k", u, momentum)
    if element.grounded:
        return _BodyMotion(energy, np.zeros((6, len(energy))), np.zeros((6, len(energy))))
    centre = pin.SE3(np.eye(3), element.mass_properties().centre)
    rigid = element.rigid_body_modes() @ np.asarray(centre.toActionMatrix())
    inertia = rigid.T @ element.mass @ rigid
    twist = np.linalg.lstsq(inertia, rigid.T @ momentum, rcond=1e-12)[0]
    turn = system.output_placement.rotation.T @ system.placements[body].rotation
    return _BodyMotion(energy, _by_axis(twist, inertia, turn), _by_axis(twist, inertia, np.eye(3)))


def _by_axis(twist: FloatArray, inertia: FloatArray, turn: FloatArray) -> FloatArray:
    axes = np.kron(np.eye(2), turn)
    diagonal = np.diag(axes @ inertia @ axes.T)
    return np.asarray(np.sqrt(np.maximum(diagonal, 0.0))[:, None] * (axes @ twist))


def _character(
    system: System,
    groups: Mapping[str, Sequence[str]],
    motions: Mapping[str, _BodyMotion],
    output: FloatArray,
    mode: int,
) -> Character:
    energy = {body: float(motion.energy[mode]) for body, motion in motions.items()}
    shares = shares_by_group(energy, system.stems)
    leading = next(iter(shares))
    bodies = groups[leading]
    words = _alone(motions[bodies[0]], mode) if len(bodies) == 1 else _together(bodies, leading, motions, mode)
    return Character(leading, words, shares, _axes(output))


def _alone(motion: _BodyMotion, mode: int) -> str:
    if not motion.is_rigid(mode):
        return "deforming"
    return _axes(motion.output[:, mode])


def _axes(motion: FloatArray) -> str:
    """The leading axis of a motion (6,), and the second where it has a share worth naming."""
    first, second = np.argsort(-(motion**2))[:2]
    both = motion[second] ** 2 > _MOVING_SHARE * motion[first] ** 2
    return _OUTPUT_AXES[first] + (f", {_OUTPUT_AXES[second]}" if both else "")


def _together(bodies: Sequence[str], stem: str, motions: Mapping[str, _BodyMotion], mode: int) -> str:
    """Of several like bodies: which take part, along or about which of their own axes, and in which phase."""
    energy = np.array([motions[body].energy[mode] for body in bodies])
    own = np.array([motions[body].own[:, mode] for body in bodies])
    if (own**2).sum() < _RIGID_SHARE * energy.sum():
        return f"{_which(bodies, stem, energy)}deforming"
    axis = int(np.argmax((own**2).sum(axis=0)))
    along = own[:, axis]
    signs = set(np.sign(along[_takes_part(along**2)]))
    phase = "" if np.sum(_takes_part(along**2)) == 1 else " in phase" if len(signs) == 1 else " out of phase"
    return f"{_which(bodies, stem, along**2)}{_OWN_AXES[axis]}{phase}"


def _takes_part(energy: FloatArray) -> BoolArray:
    return np.asarray(energy > _MOVING_SHARE * energy.max())


def _which(bodies: Sequence[str], stem: str, energy: FloatArray) -> str:
    """The numbers of the bodies that take part, nothing if all do."""
    part = _takes_part(energy)
    numbers = [body.removeprefix(stem).lstrip("_") for body, moves in zip(bodies, part, strict=True) if moves]
    return "" if part.all() else " ".join(numbers) + " "
