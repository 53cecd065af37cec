"""Rigid bodies and rigid joints on elastic drives: the engine must equal Pinocchio's own rigid-body dynamics.

The twin takes the joint-space inertia matrix (CRBA) of the open tree, restricts it to the null space of the closures
and puts the drives' stiffness on the actuated joints.
"""

import numpy as np
import pinocchio as pin
import pytest
from scipy.linalg import eigh, null_space

import prs_model as prs
from prs_model.reduction import SuperElement, TravellingElement
from prs_model.synthesis import assemble

DRIVE = 2.0e7  # N/m
MACHINES = {
    "hexapod": ({}, [dict(), dict(x=0.002, z=0.088, ry=0.03)]),
    "head_3prs": (
        {
            "joints.P": dict(
                per="limb",
                urdf="slide_<limb>",
                between=("board_<limb>.rail", "slider_<limb>.carriages"),
                rigid=True,
                drive=dict(kind="constant", stiffness=DRIVE / 1e3),
            ),
            "joints.R": dict(
                per="limb", urdf="hinge_<limb>", between=("slider_<limb>.hinge", "rod_<limb>.hinge"), rigid=True
            ),
            "joints.S": dict(
                per="limb",
                between=("rod_<limb>.tip", "platform.socket_<limb>"),
                stages=tuple(dict(urdf=f"s{k}_<limb>", rigid=True) for k in (3, 4, 5)),
            ),
            "joints.seat": dict(
                per="limb", frame="board_<limb>", between=("base.seat_<limb>", "board_<limb>.seat"), rigid=True
            ),
        },
        [dict(), dict(nutation=0.4, precession=1.1, z=1.25)],
    ),
}


def rigid_twin(part: SuperElement | TravellingElement, value: float) -> SuperElement:
    """The part with the same mass, centre and inertia and no flexibility; a grounded one does not move at all."""
    element = part.at(value) if isinstance(part, TravellingElement) else part
    motion = np.zeros((len(element.nodes), 6, 0 if element.grounded else 6))
    if not element.grounded:
        motion[:] = [pin.SE3(np.eye(3), -r).toActionMatrix() for r in element.positions]
    phi = element.rigid_body_modes()[:, : motion.shape[2]]
    mass = phi.T @ element.mass @ phi
    mass = 0.5 * (mass + mass.T)
    return SuperElement(np.zeros_like(mass), mass, element.nodes, element.positions, motion, grounded=element.grounded)


def pinocchio_frequencies(machine: prs.Machine, configuration, elements) -> np.ndarray:
    """Natural frequencies [Hz] from CRBA on the closures' null space."""
    description = machine.description
    model = pin.buildModelFromUrdf(str(description.urdf_path))
    for joint in range(model.njoints):
        model.inertias[joint] = pin.Inertia.Zero()
    for name, body in description.bodies.items():
        if not elements[name].grounded:
            frame = model.frames[model.getFrameId(body.frame)]
            mass = elements[name].mass_properties()
            inertia = pin.Inertia(mass.mass, mass.centre, mass.inertia)
            model.appendBodyToJoint(frame.parentJoint, inertia, frame.placement)
    data = model.createData()
    q = np.array([configuration.joint_values[name] for name in model.names[1:]])
    inertia = pin.crba(model, data, q)
    inertia = np.triu(inertia) + np.triu(inertia, 1).T
    pin.computeJointJacobians(model, data, q)
    pin.updateFramePlacements(model, data)

    def jacobian(frame: str) -> np.ndarray:
        return pin.getFrameJacobian(model, data, model.getFrameId(frame), pin.LOCAL_WORLD_ALIGNED)

    closures = np.vstack([jacobian(c.between[0]) - jacobian(c.between[1]) for c in description.closures.values()])
    free = null_space(closures, rcond=1e-9)
    actuated = {joint.urdf for joint in description.joints.values() if joint.drive is not None}
    drives = np.diag([DRIVE if name in actuated else 0.0 for name in model.names[1:]])
    values = eigh(free.T @ drives @ free, free.T @ inertia @ free, eigvals_only=True)
    return np.sqrt(values) / (2 * np.pi)


@pytest.mark.parametrize(("name", "pose"), [(name, pose) for name, (_, poses) in MACHINES.items() for pose in poses])
def test_rigid_machine_equals_crba_on_the_closure_null_space(name: str, pose: dict[str, float]) -> None:
    machine = prs.load_machine(name).replace(MACHINES[name][0])
    configuration = machine.configuration(**pose)
    elements = {
        body: rigid_twin(part, configuration.joint_values.get(getattr(part, "joint", ""), 0.0))
        for body, part in machine.parts.items()
    }
    system = assemble(machine.description, elements, machine.joints, configuration)
    expected = pinocchio_frequencies(machine, configuration, elements)
    assert system.size == len(machine.pose_names)
    np.testing.assert_allclose(system.modes(system.size).frequencies, expected, rtol=1e-8)


def test_published_frequencies_of_the_hexapod() -> None:
    """tdehaeze/stewart-simscape, org/identification.org; equal pairs by the platform's symmetry."""
    frequencies = prs.load_machine("hexapod").modes(6).frequencies
    np.testing.assert_allclose(frequencies, [780.6, 780.6, 903.9, 1061.4, 1061.4, 1269.6], atol=0.1)
    np.testing.assert_allclose(frequencies[[0, 3]], frequencies[[1, 4]], rtol=1e-7)
