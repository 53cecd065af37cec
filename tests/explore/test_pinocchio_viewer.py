"""Mode shapes as Pinocchio's visualizers take them."""

import re
from typing import Any

import numpy as np
import pinocchio as pin
import pytest

import prs_model as prs
from prs_model.explore import mode_motion, show_mode


def test_bodies_move_as_the_mode_does() -> None:
    modes = prs.load_machine("hexapod").modes(6)
    motion = mode_motion(modes, 5, amplitude=1e-4, frames=4)
    data = motion.model.createData()
    placements = []
    for q in motion.configurations:
        pin.forwardKinematics(motion.model, data, q)
        placements.append([data.oMi[j].copy() for j in range(1, motion.model.njoints)])
    names = list(motion.model.names)[1:]
    assert names == list(modes.system.elements)
    tool = modes.system.elements["platform"].positions[modes.system.elements["platform"].node("M")]
    platform = names.index("platform")
    moved = placements[1][platform].act(tool) - placements[0][platform].act(tool)
    along = modes.system.output_placement.rotation.T @ moved
    expected = modes.output_shapes[:3, 4]
    assert along / np.linalg.norm(along) == pytest.approx(expected / np.linalg.norm(expected), abs=1e-3)
    for name, place in zip(names, placements[2], strict=True):  # the phase is zero again
        assert place.isApprox(modes.system.placements[name], 1e-9)


def test_the_largest_displacement_is_the_amplitude() -> None:
    modes = prs.load_machine("hexapod").modes(3)
    motion = mode_motion(modes, 1, amplitude=0.001, frames=4)
    data, geometry = motion.model.createData(), motion.geometry.createData()
    seen = []
    for q in motion.configurations[:2]:
        pin.forwardKinematics(motion.model, data, q)
        pin.updateGeometryPlacements(motion.model, data, motion.geometry, geometry)
        seen.append(
            np.vstack(
                [
                    [place.act(point) for point in np.array(solid.geometry.points())]
                    for place, solid in zip(geometry.oMg, motion.geometry.geometryObjects, strict=True)
                ]
            )
        )
    largest = np.linalg.norm(seen[1] - seen[0], axis=1).max()
    assert largest == pytest.approx(0.001 * np.linalg.norm(np.ptp(seen[0], axis=0)), rel=0.1)


@pytest.mark.filterwarnings("ignore::DeprecationWarning")  # pinocchio.visualize imports all viewers there are
def test_it_plays_in_the_window_of_a_visualizer() -> None:
    viser: Any = pytest.importorskip("viser", reason="the extra `viz`")
    from pinocchio.visualize import ViserVisualizer

    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    try:
        own = ViserVisualizer(pin.Model(), pin.GeometryModel(), pin.GeometryModel())
        own.initViewer(viewer=server)
        modes = prs.load_machine("head_3prs").modes(2)
        shown: Any = show_mode(own, modes, 2, periods=1, period=0.1, frames=4)
        assert shown.viewer is server
        seen = shown.frames["mode/visual/platform"]
        assert seen.position == pytest.approx(modes.system.placements["platform"].translation)
    finally:
        server.stop()


@pytest.mark.parametrize("number", [0, 4, -1])
def test_a_mode_that_is_not_there(number: int) -> None:
    modes = prs.load_machine("hexapod").modes(3)
    with pytest.raises(prs.PrsError, match=f"found {number}, expected one of the 3 that were solved for"):
        mode_motion(modes, number)


@pytest.mark.parametrize(
    ("how", "words"),
    [
        ({"number": 1.5}, "mode: found 1.5, expected one of the 3"),
        ({"number": True}, "mode: found True, expected one of the 3"),
        ({"frames": 0}, "frames: found 0, expected a whole number above zero"),
        ({"frames": -1}, "frames: found -1, expected a whole number above zero"),
        ({"frames": 2.5}, "frames: found 2.5"),
        ({"amplitude": float("nan")}, "amplitude: found nan, expected a number above zero"),
        ({"amplitude": "large"}, "amplitude: found 'large', expected a number above zero"),
        ({"period": 0.0}, "period: found 0.0, expected a number above zero"),
    ],
)
def test_a_motion_that_makes_no_sense(how: dict[str, Any], words: str) -> None:
    modes = prs.load_machine("hexapod").modes(3)
    with pytest.raises(prs.PrsError, match=re.escape(words)):
        mode_motion(modes, **{"number": 1, **how})
