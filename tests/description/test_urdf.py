"""The URDF reader agrees with Pinocchio about what is sound, and says more about what is not."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from prs_model.description.urdf import read_urdf
from prs_model.errors import DescriptionError, UnknownNameError

GANTRY = Path(__file__).parent / "small_machine" / "gantry.urdf"


@pytest.fixture
def written(tmp_path: Path) -> Callable[[str], Path]:
    """A function that writes URDF text to a file."""

    def write(text: str) -> Path:
        path = tmp_path / "test.urdf"
        path.write_text(text)
        return path

    return write


def test_tree_is_the_one_pinocchio_reads() -> None:
    urdf, model = read_urdf(GANTRY), pin.buildModelFromUrdf(str(GANTRY))
    assert set(urdf.movable) == set(model.names[1:])
    for name, joint in urdf.movable.items():
        index = model.getJointId(name)
        assert model.lowerPositionLimit[model.joints[index].idx_q] == joint.lower
        assert model.upperPositionLimit[model.joints[index].idx_q] == joint.upper
    assert {frame.name for frame in model.frames if frame.type == pin.FrameType.BODY} == set(urdf.links)
    bridge = urdf.links["bridge"].inertial
    assert bridge is not None
    assert bridge.mass == 80
    np.testing.assert_array_equal(bridge.inertia, np.diag([9.0, 1.0, 9.0]))


def test_joints_and_their_axes() -> None:
    urdf = read_urdf(GANTRY)
    assert urdf.root == "bed"
    assert urdf.joints["y"].free_axis == "uy"
    assert urdf.joints["seat_left"].free_axis is None
    with pytest.raises(UnknownNameError, match="Did you mean 'x_left'"):
        urdf.joint("x_lef")


@pytest.mark.parametrize(
    ("kind", "axis", "free"),
    [
        ("revolute", "0 0 -2", "rz"),
        ("continuous", "1 0 0", "rx"),
        ("prismatic", "0 3 0", "uy"),
        ("revolute", "1 1 0", None),
    ],
)
def test_free_axis(written: Callable[[str], Path], kind: str, axis: str, free: str | None) -> None:
    path = written(
        f"""<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="{kind}"><parent link="a"/>
        <child link="b"/><axis xyz="{axis}"/><limit lower="-1" upper="1" effort="0" velocity="0"/></joint></robot>"""
    )
    joint = read_urdf(path).joints["j"]
    assert joint.free_axis == free
    assert np.linalg.norm(joint.axis) == pytest.approx(1.0)


def test_all_problems_are_told_at_once_with_their_lines(written: Callable[[str], Path]) -> None:
    path = written(
        """<robot>
        <link name="a"><inertial><mass value="-1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0"/></inertial></link>
        <link name="b"/>
        <joint name="j" type="revolute"><parent link="a"/><child link="c"/>
          <axis xyz="0 0 nan"/>
          <mimic joint="k"/>
          <limit lower="0" upper="pi" effort="0"/>
        </joint>
        <jiont name="k"/>
        </robot>"""
    )
    with pytest.raises(DescriptionError) as caught:
        read_urdf(path)
    assert [(problem.line, problem.entry) for problem in caught.value.problems] == [
        (1, "<robot>"),
        (2, "link 'a': mass"),
        (2, "link 'a': inertia"),
        (4, "joint 'j': child"),
        (5, "joint 'j': axis: xyz"),
        (6, "joint 'j'"),
        (7, "joint 'j': limit"),
        (7, "joint 'j': limit"),
        (9, "<jiont>"),
    ]


def test_a_ring_of_links_is_found(written: Callable[[str], Path]) -> None:
    ring = "".join(
        f'<joint name="{a}{b}" type="fixed"><parent link="{a}"/><child link="{b}"/></joint>'
        for a, b in ("bc", "cd", "db")
    )
    links = "".join(f'<link name="{name}"/>' for name in "abcd")
    with pytest.raises(DescriptionError, match=r"their own ancestors \(b, c, d\)"):
        read_urdf(written(f'<robot name="r">{links}{ring}</robot>'))


@pytest.mark.parametrize("key", ["xyz", "upper"])
@pytest.mark.parametrize("text", ["1", "+1", " 1", "1 ", "1.", ".5", "1E+0", "1_0", "0x1", "1d0", "1e", "&#9;1", "１"])
def test_what_is_read_as_a_number_pinocchio_reads_too(written: Callable[[str], Path], key: str, text: str) -> None:
    given = {"xyz": "0", "upper": "1"} | {key: text}
    path = written(
        f"""<robot name="r"><link name="a"/><link name="b"/><joint name="j" type="prismatic"><parent link="a"/>
        <child link="b"/><origin xyz="0 0 {given["xyz"]}"/><axis xyz="0 0 1"/>
        <limit lower="-1" upper="{given["upper"]}" effort="0" velocity="0"/></joint></robot>"""
    )
    try:
        joint = read_urdf(path).joints["j"]
    except DescriptionError:
        assert text not in ("1", "+1", " 1", "1.", ".5", "1E+0")
        return
    model = pin.buildModelFromUrdf(str(path))
    assert model.jointPlacements[1].translation[2] == joint.xyz[2]
    assert model.upperPositionLimit[0] == joint.upper


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("<sdf/>", "expected <robot>"),
        ("", "not valid XML: no element found"),
        ("<robot name='r'/>", "found no links"),
        ("<!DOCTYPE r [<!ENTITY a 'b'><!ENTITY c '&a;&a;'>]><robot name='&c;'/>", "not allowed"),
    ],
)
def test_what_is_no_urdf(written: Callable[[str], Path], text: str, words: str) -> None:
    with pytest.raises(DescriptionError, match=words):
        read_urdf(written(text))


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(DescriptionError, match=r"nothing\.urdf: cannot be read"):
        read_urdf(tmp_path / "nothing.urdf")
