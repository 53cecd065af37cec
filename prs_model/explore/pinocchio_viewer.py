"""A mode in a viewer that a user of Pinocchio has already: Meshcat, viser, or any other of its visualizers.

They place rigid geometry by joint values and draw nothing that deforms. So every body becomes one on a free-flyer joint
of its own, and moves as the rigid motion that fits its part of the mode best; what it bends is not seen.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import Any, Protocol, TypeGuard

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray, IntArray
from ..errors import PrsError, short
from ..modes import Modes
from ..modes.drawn import AMPLITUDE, drawn_bodies, largest_length, machine_size
from ..reduction import Surface
from ..synthesis import System

_STILL = np.array([0.69, 0.75, 0.79, 1.0])
_SEEN_THROUGH = np.array([0.69, 0.75, 0.79, 0.25])


class Visualizer(Protocol):
    """What is used of one of Pinocchio's visualizers."""

    viewer: Any

    def initViewer(self, viewer: Any) -> None: ...  # noqa: N802

    def loadViewerModel(self, rootNodeName: str) -> None: ...  # noqa: N802

    def play(self, q_trajectory: Any, dt: float) -> None: ...

    def display(self, q: Any) -> None: ...


@dataclass(frozen=True, eq=False)
class ModeMotion:
    """One period of a mode: a model of free bodies, their geometry, and joint values (frames, nq) `dt` [s] apart."""

    model: pin.Model
    geometry: pin.GeometryModel
    configurations: FloatArray
    dt: float


def mode_motion(
    modes: Modes, number: int, *, amplitude: float = AMPLITUDE, frames: int = 40, period: float = 2.0
) -> ModeMotion:
    """Mode `number`, counted from 1, as joint values for any of Pinocchio's visualizers.

    amplitude: largest displacement over the machine's size; period: of the animation [s], not of the mode.
    Raises PrsError for a mode that has not been solved for, or numbers that make no motion.
    """
    _check_mode(modes, number)
    _check_whole("frames", frames)
    _check_positive("amplitude", amplitude)
    _check_positive("period", period)
    bodies = drawn_bodies(modes.system)
    twists = _rigid_motions(modes, number - 1)
    largest = max(largest_length(_under(twists[name], body.points)) for name, body in bodies.items()) or 1.0
    scale = amplitude * machine_size(modes.system, bodies) / largest
    phases = np.sin(2.0 * np.pi * np.arange(frames) / frames)
    configurations = [_joint_values(modes.system, twists, scale * phase) for phase in phases]
    return ModeMotion(*_free_bodies(modes.system, bodies), np.array(configurations), period / frames)


def show_mode(
    visualizer: Visualizer, modes: Modes, number: int, *, periods: int = 3, name: str = "mode", **how: float
) -> Visualizer:
    """Play a mode in the window of a visualizer, such as a MeshcatVisualizer whose `initViewer` has been called.

    The bodies appear beside what it shows, below `name`; how: as of `mode_motion`. Returns the visualizer of the mode.
    Raises PrsError for a mode that has not been solved for.
    """
    _check_whole("periods", periods)
    motion = mode_motion(modes, number, **how)  # type: ignore[arg-type]
    kind: Any = type(visualizer)
    shown: Visualizer = kind(motion.model, pin.GeometryModel(), motion.geometry)
    shown.initViewer(viewer=visualizer.viewer)
    shown.loadViewerModel(name)
    shown.play(list(np.tile(motion.configurations, (periods, 1))), motion.dt)
    shown.display(motion.configurations[0])
    return shown


def _check_mode(modes: Modes, number: object) -> None:
    count = len(modes.frequencies)
    if not _is_whole(number) or not 1 <= number <= count:
        expected = f"one of the {count} that were solved for, from 1 to {count}"
        raise PrsError(f"mode: found {short(repr(number))}, expected {expected}")


def _check_whole(what: str, given: object) -> None:
    if not _is_whole(given) or given < 1:
        raise PrsError(f"{what}: found {short(repr(given))}, expected a whole number above zero")


def _check_positive(what: str, given: object) -> None:
    if not isinstance(given, int | float | np.integer | np.floating) or not 0.0 < given < inf:
        raise PrsError(f"{what}: found {short(repr(given))}, expected a number above zero")


def _is_whole(given: object) -> TypeGuard[int]:
    return isinstance(given, int | np.integer) and not isinstance(given, bool)


def _rigid_motions(modes: Modes, mode: int) -> dict[str, FloatArray]:
    """The twist (6,) of each body, in its own frame, with the same momentum as its part of the mode."""
    return {name: _fitted(modes, name, mode) for name in modes.system.elements}


def _fitted(modes: Modes, name: str, mode: int) -> FloatArray:
    element = modes.system.elements[name]
    if element.grounded:
        return np.zeros(6)
    rigid = element.rigid_body_modes()
    momentum = rigid.T @ element.mass @ modes.body_shapes(name)[:, mode]
    return np.asarray(np.linalg.lstsq(rigid.T @ element.mass @ rigid, momentum, rcond=1e-12)[0])


def _under(twist: FloatArray, points: FloatArray) -> FloatArray:
    """Displacements (p, 3) of points under a small rigid motion about the origin."""
    return np.asarray(twist[:3] + np.cross(twist[3:], points))


def _joint_values(system: System, twists: dict[str, FloatArray], scale: float) -> FloatArray:
    moved = [system.placements[name] * pin.exp6(pin.Motion(scale * twist)) for name, twist in twists.items()]
    return np.concatenate([pin.SE3ToXYZQUAT(place) for place in moved])


def _free_bodies(system: System, bodies: dict[str, Surface]) -> tuple[pin.Model, pin.GeometryModel]:
    model, geometry = pin.Model(), pin.GeometryModel()
    for name, body in bodies.items():
        joint = model.addJoint(0, pin.JointModelFreeFlyer(), pin.SE3.Identity(), name)
        seen = pin.GeometryObject(name, joint, pin.SE3.Identity(), _solid(body.points, body.triangles))
        seen.meshColor = _SEEN_THROUGH if system.elements[name].grounded else _STILL
        geometry.addGeometryObject(seen)
    return model, geometry


def _solid(points: FloatArray, triangles: IntArray) -> Any:
    """coal's class for triangles in memory that all viewers draw; convex or not is all the same to them."""
    import coal

    corners = coal.StdVec_Vec3s()
    corners.extend(list(points))
    faces = coal.StdVec_Triangle()
    faces.extend([coal.Triangle(*map(int, triangle)) for triangle in triangles])
    return coal.Convex(corners, faces)
