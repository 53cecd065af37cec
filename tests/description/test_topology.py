"""Elastic joints between the wrong bodies, on the wrong URDF joint, or over the wrong stroke."""

from __future__ import annotations

import shutil
from pathlib import Path
from typing import Any

import pytest

from prs_model import plugins
from prs_model.description import load_description, replaced
from prs_model.errors import DescriptionError

SMALL_MACHINE = Path(__file__).parent / "small_machine"
STRUT = {"per": "limb", "urdf": "strut_<limb>", "between": ["lower_<limb>.slide", "upper_<limb>.slide"], "rigid": True}
SLEEVE = {"per": "limb", "frame": "lower_<limb>", "between": ["lower_<limb>.slide", "upper_<limb>.slide"]}
LATERAL = {"ux": 1e6, "uy": 1e6, "rx": 1e3, "ry": 1e3, "rz": 1e3}
STATIONS = [500, 600, 700, 800, 900]
RAIL = "bodies.board.interfaces.rail.travel"

# machine, what is changed in it, and each problem's entry with words of its message
WRONG: dict[str, tuple[str, dict[str, Any], dict[str, str]]] = {
    "a joint listed twice": (
        "hexapod",
        {"joints.P2": STRUT},
        {"joints.P2.urdf": "found 'strut_1' a second time (first for joint 'P_1' in joints.P.urdf)"},
    ),
    "one URDF joint for all limbs": (
        "hexapod",
        {"joints.P.urdf": "strut_2"},
        {"joints.P.urdf": "found 'strut_2', which is between links 'lower_2' and 'upper_2'"},
    ),
    "one URDF joint in two stages": (
        "hexapod",
        {"joints.U.stages[0].urdf": "u2_<limb>"},
        {"joints.U.stages[1].urdf": "found 'u2_1' a second time (first for joint 'U_1' in joints.U.stages[0].urdf)"},
    ),
    "URDF joints exchanged": (
        "hexapod",
        {"joints.P_1.urdf": "strut_2", "joints.P_2.urdf": "strut_1"},
        {
            "joints.P_1.urdf": "a joint between links 'lower_1' and 'upper_1'",
            "joints.P_2.urdf": "found 'strut_1', which is between links 'lower_1' and 'upper_1'",
        },
    ),
    "ends exchanged": (
        "hexapod",
        {
            "joints.P_1.between": ["lower_1.slide", "upper_2.slide"],
            "joints.P_2.between": ["lower_2.slide", "upper_1.slide"],
        },
        {
            "joints.P_1.between[1]": "found 'upper_2.slide' on link 'upper_2', expected an end on link 'upper_1'",
            "joints.P_2.between[1]": "where strut_2 leads from 'lower_2.slide'",
        },
    ),
    "a body on the wrong link": (
        "hexapod",
        {"bodies.upper.frame": "lower_<limb>"},
        {
            "joints.P.between[1]": "found 'upper_1.slide' on link 'lower_1', expected an end on link 'upper_1'",
            "joints.S.between[0]": "or the frame of the body",
        },
    ),
    "stages out of order": (
        "hexapod",
        {"joints.S.stages[1].urdf": "s3_<limb>", "joints.S.stages[2].urdf": "s2_<limb>"},
        {"joints.S.stages[1].urdf": "expected one that leads on from link 's_a_1'"},
    ),
    "rods exchanged": (
        "head_3prs",
        {
            "joints.R_1.between": ["slider_1.hinge", "rod_2.hinge"],
            "joints.R_2.between": ["slider_2.hinge", "rod_1.hinge"],
        },
        {
            "joints.R_1.between[1]": "found 'rod_2.hinge' on link 'rod_2', expected an end on link 'rod_1'",
            "joints.R_2.between[1]": "found 'rod_1.hinge' on link 'rod_1', expected an end on link 'rod_2'",
        },
    ),
    "on the board of another limb": (
        "head_3prs",
        {"joints.P_1.between": ["board_2.rail", "slider_1.carriages"]},
        {"joints.P_1.between[0]": "which travels with 'slide_2', expected an interface that travels with slide_1"},
    ),
    "URDF joint held by nothing": (
        "hexapod",
        {"joints.P": {**SLEEVE, "stiffness": {**LATERAL, "uz": 0}}},
        {"joints": "that holds strut_1, strut_2, strut_3, strut_4, strut_5, strut_6 of the URDF"},
    ),
    "a lock in place of a URDF joint": (
        "hexapod",
        {"joints.P": {**SLEEVE, "stiffness": {**LATERAL, "uz": 1e6}}},
        {"joints.P.between": "links 'lower_1' and 'upper_1', which move against each other"},
    ),
    "frame that moves against both ends": (
        "head_3prs",
        {"joints.seat.frame": "rod_<limb>"},
        {"joints.seat.frame": "found 'rod_1', which moves against both ends"},
    ),
    "stations short of the stroke": (
        "head_3prs",
        {f"{RAIL}.stations": [600, 650, 700, 750]},
        {f"{RAIL}.stations": "600 .. 750 mm, expected them to cover the limits of 'slide_1' (500 .. 900 mm"},
    ),
    "boards that travel with one slide": (
        "head_3prs",
        {f"{RAIL}.joint": "slide_1"},
        {f"{RAIL}.joint": "found 'slide_1', expected slide_2, with which joint 'P_2' moves along 'board_2.rail'"},
    ),
    "members without an interface": (
        "head_3prs",
        {"joints.R.interfaces": [{"name": "b1", "rigid": True}]},
        {"joints.R.interfaces": "found none for b2 of 'slider_1.hinge', which would carry nothing"},
    ),
    "member of an interface with one node": (
        "head_3prs",
        {"joints.R.between": ["slider_<limb>.hinge.b1", "rod_<limb>.hinge"], "reduction.method": "craig-bampton"},
        {"joints.R.between[0]": "'hinge' has one node for all its members: name 'hinge', or give it 'tie: interface'"},
    ),
    "output at a node for all members": (
        "head_3prs",
        {"output.node": "rod_1.hinge", "reduction.tie": "interface"},
        {"output.node": "expected an interface of body 'rod_1' (hinge.b1, hinge.b2, tip)"},
    ),
}  # fmt: skip

RIGHT: dict[str, tuple[str, dict[str, Any]]] = {
    "stages from the other end": (
        "hexapod",
        {"joints.U.stages": [{"urdf": "u2_<limb>", "rigid": True}, {"urdf": "u1_<limb>", "rigid": True}]},
    ),
    "ends the other way round": ("hexapod", {"joints.P.between": ["upper_<limb>.slide", "lower_<limb>.slide"]}),
    "a joint inside a body": (
        "hexapod",
        {"joints.link": {"frame": "platform", "between": ["platform.joint_1", "platform.joint_4"], "rigid": True}},
    ),
    "a spring beside a drive": (
        "hexapod",
        {
            "joints.balance": {
                "frame": "platform",
                "between": ["ground", "platform.M"],
                "stiffness": {"ux": 0, "uy": 0, "uz": 1e4, "rx": 0, "ry": 0, "rz": 0},
            }
        },
    ),
    "more stations than the stroke needs": ("head_3prs", {f"{RAIL}.stations": [450, *STATIONS, 950]}),
    "members tied one by one": (
        "head_3prs",
        {
            "reduction.tie": "interface",
            "output.node": "rod_1.hinge.b1",
            "joints.R.between": ["slider_<limb>.hinge", "rod_<limb>.hinge"],
        },
    ),
}  # fmt: skip


@pytest.mark.parametrize(("machine", "changes", "expected"), WRONG.values(), ids=WRONG)
def test_what_does_not_fit_together(machine: str, changes: dict[str, Any], expected: dict[str, str]) -> None:
    sound = load_description(plugins.machine_folder(machine))
    with pytest.raises(DescriptionError) as caught:
        replaced(sound, changes)
    assert {problem.entry for problem in caught.value.problems} == set(expected), str(caught.value)
    for problem in caught.value.problems:
        assert expected[problem.entry] in problem.message


@pytest.mark.parametrize(("machine", "changes"), RIGHT.values(), ids=RIGHT)
def test_what_may_be(machine: str, changes: dict[str, Any]) -> None:
    replaced(load_description(plugins.machine_folder(machine)), changes)


CLOSURE = "closures:\n  bridge: {between: [bridge_at_right, bridge_seat_right], kind: frame}\n"
HINGE = "closures:\n  bridge: {between: [bridge_at_right, bridge_seat_right], kind: point}\n"


def gantry(folder: Path, *edits: tuple[str, str]) -> Path:
    shutil.copytree(SMALL_MACHINE, folder, dirs_exist_ok=True)
    text = (folder / "machine.yaml").read_text()
    for old, new in edits:
        assert text.count(old) == 1
        text = text.replace(old, new)
    (folder / "machine.yaml").write_text(text)
    return folder


def test_a_point_closure_may_be_a_joint_of_its_own(tmp_path: Path) -> None:
    """The right foot meets the bridge in one point; the seat between them has a frame and no URDF joint."""
    load_description(gantry(tmp_path, (CLOSURE, HINGE)))


def test_without_its_closure_a_seat_joins_what_moves(tmp_path: Path) -> None:
    with pytest.raises(DescriptionError) as caught:
        load_description(gantry(tmp_path, (CLOSURE, "")))
    assert [problem.entry for problem in caught.value.problems] == ["joints.seat.between"]


def test_a_screw_may_fit_its_joint_exactly(tmp_path: Path) -> None:
    """-350 mm and 1250 mm make 0.8999999999999999 m, which is the joint's limit of 0.9 m but for round-off."""
    load_description(gantry(tmp_path, ("length: 1000, origin: -50}", "length: 1250, origin: -350}")))
