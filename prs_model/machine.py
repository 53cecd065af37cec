"""A machine: its description, and everything that is built from it once and used at many poses."""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING

from . import plugins
from .description import MachineDescription, load_description, replaced
from .errors import PrsError, short
from .readable import readable, readable_range

if TYPE_CHECKING:
    import xarray
    from numpy.typing import ArrayLike

    from .complete_order import CompleteOrder
    from .description.schema import Coupling
    from .joints import ElasticJoint
    from .kinematics import Configuration, Kinematics
    from .modes import Modes
    from .reduction import SuperElement, TravellingElement
    from .synthesis import System

_log = logging.getLogger(__name__)


@dataclass(frozen=True, eq=False, repr=False)
class Machine:
    """A parallel kinematic machine as described; immutable. Parts and kinematics are made when first needed."""

    description: MachineDescription

    def __repr__(self) -> str:
        return f"Machine({self.name!r}, {len(self.description.bodies)} bodies, {len(self.description.joints)} joints)"

    @property
    def name(self) -> str:
        return self.description.file.name

    @property
    def pose_names(self) -> tuple[str, ...]:
        """Names of the pose coordinates, in the order of the task."""
        return self.kinematics.pose_names

    @property
    def reference_pose(self) -> Mapping[str, float]:
        """The pose of the stored reference configuration [m, rad]."""
        return self.description.reference_pose

    @property
    def workspace(self) -> Mapping[str, tuple[float, float]]:
        """The stated bounds of each pose coordinate [m, rad]. Poses beyond them are solved where joints allow it."""
        return self.description.workspace

    @cached_property
    def kinematics(self) -> Kinematics:
        """Closed loops of the machine, solved on Pinocchio's tree."""
        from .kinematics import Kinematics

        return Kinematics(self.description)

    @cached_property
    def parts(self) -> Mapping[str, SuperElement | TravellingElement]:
        """The super-element of every body, constant in its body frame."""
        from .joint_loaded import joint_loaded_parts
        from .reduction import build_part

        file, folder, stems = self.description.file, self.description.folder, self.description.stems
        parts = {
            name: build_part(name, body, file.reduction, folder, stem=stems[name])
            for name, body in self.description.bodies.items()
        }
        return joint_loaded_parts(self.description, parts, self.joints, self.configuration)

    @cached_property
    def joints(self) -> tuple[ElasticJoint, ...]:
        """The elastic joints, with everything that does not depend on the pose worked out."""
        from .joints import elastic_joints

        return elastic_joints(self.description)

    def configuration(self, /, **pose: float) -> Configuration:
        """The configuration at a pose [m, rad]; coordinates left out take their reference values.

        Raises UnreachablePoseError naming the joint, and PrsError for a coordinate the task does not have or a value
        that is no number.
        """
        return self.kinematics.solve({**self.reference_pose, **pose})

    def assemble(self, configuration: Configuration | None = None) -> System:
        """The synthesised system in a configuration (default: the reference).

        Joints whose ends lie apart and bodies that no joint holds are warned of, once for each machine.
        """
        from .synthesis import assemble

        _ = self._warned
        return assemble(self.description, self.parts, self.joints, configuration or self.configuration())

    def wide_joints(self) -> tuple[str, ...]:
        """A sentence for each joint whose ends lie apart in the reference configuration, which is seldom meant."""
        from .synthesis import wide_joints

        joints = self.description.joints
        gaps = wide_joints(self.description, self.parts, self.joints, self.configuration())
        return tuple(
            f"joint '{name}': its ends {' and '.join(joints[name].between)} lie {1e3 * gap:.4g} mm apart; "
            "check 'at', the node positions, the body's frame and the units of its file"
            for name, gap in gaps.items()
        )

    def loose_bodies(self) -> tuple[str, ...]:
        """A sentence for each body that neither a joint nor the ground holds."""
        held = {end.split(".")[0] for joint in self.description.joints.values() for end in joint.between}
        bodies = self.description.bodies
        loose = [name for name, body in bodies.items() if name not in held and not body.grounded]
        return tuple(f"body '{name}' is held by no joint" for name in loose)

    def outside_workspace(self, pose: Mapping[str, float]) -> tuple[str, ...]:
        """For each coordinate of a pose [m, rad] beyond the stated workspace: how far it is from where it should be."""
        kinds, slack = self.kinematics.task.coordinates, 1e-9  # of rounding at the edge
        return tuple(
            f"outside the stated workspace: {name} {readable(pose[name], kinds[name])}, "
            f"workspace {readable_range(low, high, kinds[name])}"
            for name, (low, high) in self.workspace.items()
            if not low - slack <= pose[name] <= high + slack
        )

    @cached_property
    def _warned(self) -> None:
        for sentence in (*self.loose_bodies(), *self.wide_joints()):
            _log.warning("%s", sentence)

    def modes(self, count: int = 8, /, **pose: float) -> Modes:
        """The lowest natural modes at a pose."""
        return self.assemble(self.configuration(**pose)).modes(count)

    def sweep(
        self,
        /,
        *,
        poses: ArrayLike | None = None,
        n_modes: int = 6,
        quantities: str | Iterable[str] = ("frequency",),
        tolerance: float = 1e-6,
        band: tuple[float, float] | None = None,
        progress: Callable[[int, int], None] | None = None,
        store: str | Path | None = None,
        cluster: object = None,
        **coordinates: ArrayLike,
    ) -> xarray.Dataset:
        """What is asked at every pose of a grid, or of a list, as a dataset with names and units.

        coordinates: values of each pose coordinate [m, rad], of which all combinations are taken; those left out keep
        their reference values. poses: a list (N, d) in their place, columns as in `pose_names`.
        quantities: of prs_model.sweep.QUANTITIES. tolerance: relative, of every frequency beside the dense
        eigenproblem. band: (lowest, highest) [Hz] in which resonance peaks are sought.
        progress: called with the number of poses done and of all. store: a folder that keeps what is finished, so that
        the same call goes on after an interruption. cluster: a Dask client, or the address of its scheduler.
        Unreachable poses are marked in `reason` and have NaN. Raises PrsError for what cannot be asked of the machine.
        """
        from .sweep import Request, poses_of, sweep

        chosen = (quantities,) if isinstance(quantities, str) else tuple(quantities)
        request = Request(n_modes, chosen, tolerance, band)
        return sweep(self, poses_of(self, coordinates, poses), request, progress, store, cluster)

    def complete_order(self, coupling: Coupling = "averaged", cache: Path | None = None) -> CompleteOrder:
        """The full finite-element model of the assembly, which the reduced one is held against.

        coupling: of the interfaces, each member with a node of its own. Parts are factorized when first needed: keep it
        for several poses.
        cache: a folder where solved poses are kept, and found again while nothing that decides them has changed.
        """
        from .complete_order import CompleteOrder

        return CompleteOrder(self.description, self.joints, coupling, cache)

    def replace(self, changes: Mapping[str, object]) -> Machine:
        """A new machine with entries of its description changed, such as ``{"joints.P.drive.nut": 1.0e5}``.

        Paths are those of machine.yaml as written, or of one instance (``bodies.rod_2.modes``); values are in the
        units of the file. Raises DescriptionError as loading does.
        """
        return Machine(replaced(self.description, changes))


def load_machine(name_or_path: str | Path) -> Machine:
    """A machine by the name it is installed under, or by the path of a machine.yaml or its folder.

    Raises UnknownNameError listing the known names, DescriptionError listing everything wrong with the files, or
    PrsError for a path where nothing is.
    """
    if str(name_or_path) in plugins.list_machines():
        return Machine(load_description(plugins.machine_folder(str(name_or_path))))
    path = Path(name_or_path)
    if str(name_or_path) and _exists(path):
        return Machine(load_description(path))
    if len(path.parts) > 1 or path.suffix in {".yaml", ".yml"}:
        expected = "a machine.yaml, its folder, or an installed machine"
        raise PrsError(f"{short(path)}: no such file or folder; expected {expected}")
    raise plugins.unknown("machine", str(name_or_path), list(plugins.list_machines()))


def _exists(path: Path) -> bool:
    try:
        return path.exists()
    except OSError as error:  # no permission, or a name longer than a file system takes
        raise PrsError(f"{short(path)}: cannot be read: {error.strerror}") from error
