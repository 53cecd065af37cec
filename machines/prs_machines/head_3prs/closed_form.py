"""Inverse kinematics of a 3-PRS head in closed form."""

from __future__ import annotations

import numpy as np

from prs_model.arrays import FloatArray
from prs_model.description import schema
from prs_model.kinematics import kernels
from prs_model.kinematics.tasks import NutationPrecessionZ
from prs_model.kinematics.tree import Tree

_LIMBS = (1, 2, 3)
_JOINTS = ("slide", "hinge", "s3", "s4", "s5")


class ThreePrs(NutationPrecessionZ):
    """Nutation, precession and height of a zero-torsion head with three PRS limbs.

    Each S centre stays in the plane of its limb (it cannot leave it: the R axis is tangential). That gives three
    equations for the parasitic shift (x, y) of the tool, of second order in the nutation, and they agree because the
    platform does not twist. Slider, rod and S joint follow limb by limb. The geometry is read from the URDF:

    - slide_i along z of its limb frame (x radial, y tangential) and hinge_i about y, in `centres` at slider value zero,
    - S centre on the rod axis at `length` from the R axis, s3_i about z, s4_i about x, s5_i about y,
    - S centres of the platform and its seat axes in the tool frame.
    """

    def __init__(self, tree: Tree, section: schema.Task, options: schema.Section):
        super().__init__(tree, section, options)
        self._columns = np.array([[tree.joint(f"{joint}_{limb}") for joint in _JOINTS] for limb in _LIMBS])
        slides, hinges, tips = self._columns[:, 0], self._columns[:, 1], self._columns[:, 2]
        self._axes = tree.rotations[slides]  # (3, 3, 3), columns radial, tangential, vertical
        self._centres = tree.offsets[slides] + kernels.transform(self._axes, tree.offsets[hinges])
        self._lengths = tree.offsets[tips, 2]
        self._seats, self._seat_axes = self._platform(tree, section.frame)
        self._shift = np.linalg.pinv(self._axes[:, :2, 1])

    def closed_form(self, poses: FloatArray) -> FloatArray:
        """Joint values (N, n) [m, rad]; NaN for the joints of a limb whose rod is too short."""
        targets = self.targets(poses)
        R = kernels.rotation(np.column_stack([targets[:, :2], np.zeros(len(poses))]))
        radial, vertical = self._centres_to_tips(R, targets[:, 2])
        rise = np.sqrt(np.where(radial**2 <= self._lengths**2, self._lengths**2 - radial**2, np.nan))
        hinge = np.arctan2(radial, rise)
        rod = self._axes @ kernels.rotation(hinge[..., None] * np.array([0.0, 1.0, 0.0]))
        spherical = _zxy_angles(np.swapaxes(rod, -1, -2) @ (R[:, None] @ self._seat_axes))
        q = np.zeros((len(poses), self.tree.size))
        q[:, self._columns] = np.concatenate([np.stack([vertical - rise, hinge], axis=-1), spherical], axis=-1)
        return q

    def _centres_to_tips(self, R: FloatArray, z: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Radial and vertical distance (N, 3) from each R axis at slider value zero to its S centre."""
        tool = np.zeros((len(R), 3))
        tool[:, 2] = z
        arms = (R[:, None] @ self._seats[..., None])[..., 0] - self._centres
        off_plane = np.einsum("nij,ij->ni", arms + tool[:, None], self._axes[..., 1])
        tool[:, :2] = -off_plane @ self._shift.T
        in_limb = kernels.transform(np.swapaxes(self._axes, -1, -2), arms + tool[:, None])
        return in_limb[..., 0], in_limb[..., 2]

    @staticmethod
    def _platform(tree: Tree, tool_frame: str) -> tuple[FloatArray, FloatArray]:
        """S centres (3, 3) and seat axes (3, 3, 3) in the tool frame."""
        tool = tree.link(tool_frame)
        links = [tree.link(f"platform_seat_{limb}") for limb in _LIMBS]
        seats = [tool.rotation.T @ (link.offset - tool.offset) for link in links]
        return np.array(seats), np.array([tool.rotation.T @ link.rotation for link in links])


def _zxy_angles(R: FloatArray) -> FloatArray:
    """Angles (..., 3) with R = Rz(a) Rx(b) Ry(c)."""
    return np.stack(
        [
            np.arctan2(-R[..., 0, 1], R[..., 1, 1]),
            np.arcsin(np.clip(R[..., 2, 1], -1.0, 1.0)),
            np.arctan2(-R[..., 2, 0], R[..., 2, 2]),
        ],
        axis=-1,
    )
