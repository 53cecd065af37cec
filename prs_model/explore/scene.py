"""The machine in viser's scene: a mesh for each body, placed by the pose and deformed by the mode."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray
from ..modes import Modes
from ..modes.drawn import box_around, drawn_bodies, largest_length, machine_size, mode_displacements

if TYPE_CHECKING:
    import viser

_STILL = np.array([176, 190, 202])
_MOVING = np.array([232, 119, 34])
_GROUNDED_OPACITY = 0.25  # a frame around the machine must not hide it
_VIEW = np.array([0.82, -0.6, 0.49])  # from the machine's middle, over its size


class Scene:
    """Bodies are coloured by how far they go in the mode; one that the ground holds is seen through."""

    def __init__(self, server: viser.ViserServer, modes: Modes):
        self.server = server
        server.scene.configure_default_lights(cast_shadow=False)  # two fifths of the frames on a slow computer
        self.bodies = drawn_bodies(modes.system)
        self.size = machine_size(modes.system, self.bodies)
        self.moved = {name: np.zeros_like(body.points) for name, body in self.bodies.items()}
        self.meshes = {
            name: server.scene.add_mesh_simple(
                f"/machine/{name}",
                body.points,
                body.triangles,
                flat_shading=True,
                side="double",
                cast_shadow=False,
                receive_shadow=False,
                opacity=_GROUNDED_OPACITY if modes.system.elements[name].grounded else None,
            )
            for name, body in self.bodies.items()
        }
        self.tool = server.scene.add_frame("/output", axes_length=0.09 * self.size, axes_radius=0.003 * self.size)
        self._look(modes)

    def show(self, modes: Modes, mode: int) -> None:
        """Stand where the modes were found, and move as number `mode` of them (counted from 0)."""
        system = modes.system
        self.bodies = drawn_bodies(system)
        self.moved = {name: each[0] for name, each in mode_displacements(modes, self.bodies, [mode]).items()}
        with self.server.atomic():
            for name, mesh in self.meshes.items():
                mesh.position, mesh.wxyz = _position(system.placements[name]), _quaternion(system.placements[name])
                mesh.color = _colour(largest_length(self.moved[name]))
            self.tool.position = _position(system.output_placement)
            self.tool.wxyz = _quaternion(system.output_placement)

    def deform(self, share: float) -> None:
        """Draw all bodies with the mode's largest displacement at `share` of the machine's size."""
        with self.server.atomic():
            for name, mesh in self.meshes.items():
                deformed = self.bodies[name].points + share * self.size * self.moved[name]
                mesh.vertices = deformed.astype(np.float32)

    def _look(self, modes: Modes) -> None:
        low, high = box_around(modes.system, self.bodies)
        middle, camera = (low + high) / 2.0, self.server.initial_camera
        camera.position, camera.look_at = tuple(middle + self.size * _VIEW), tuple(middle)


def _position(place: pin.SE3) -> FloatArray:
    return np.array(place.translation)


def _quaternion(place: pin.SE3) -> FloatArray:
    """w, x, y, z; Pinocchio's order is x, y, z, w."""
    return np.roll(pin.Quaternion(place.rotation).coeffs(), 1)


def _colour(share: float) -> tuple[int, int, int]:
    red, green, blue = (_STILL + share * (_MOVING - _STILL)).astype(int).tolist()
    return red, green, blue
