"""The box of a sweep: what of its coordinates is periodic or mirrored is found out on the machine."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
import pytest

import prs_model as prs
from prs_model.sweep.interpolated.box_of import Shape, shape_of
from prs_model.sweep.poses import poses_of
from tests.sweep.nasty import nasty

TURN = 2.0 * np.pi


@pytest.fixture(scope="module")
def head() -> prs.Machine:
    return prs.load_machine("head_3prs")


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> prs.Machine:
    """Machine of x, y and phi, which turns all the way round."""
    return nasty(tmp_path_factory.mktemp("nasty"), [20.0, 30.0], 150.0)


def shape(machine: prs.Machine, poses: np.ndarray | None = None, **coordinates: object) -> Shape:
    given: Mapping[str, object] = coordinates
    return shape_of(machine.kinematics, poses_of(machine, given, poses))


def test_a_tilt_from_zero_and_its_direction_all_round_are_mirrored(head: prs.Machine) -> None:
    found = shape(head, nutation=np.linspace(0.0, 0.5, 40), precession=np.linspace(0.0, TURN, 90), z=[1.25, 1.3])
    assert found.columns == (0, 1, 2)
    assert found.periodic == (False, True, False)
    assert found.mirror == (0, 1)
    box = found.box((9, 11, 5))
    kinds = [(axis.kind, axis.count) for axis in box.axes]
    assert kinds == [("chebyshev", 10), ("fourier", 12), ("given", 2)]
    assert box.axes[0].low == -0.5
    assert len(box.poses()) == 10 // 2 * 12 * 2
    assert box.poses()[:, 0].min() > 0.0
    assert found.home == pytest.approx([0.0, np.pi, 1.275])


def test_a_part_of_a_turn_is_an_interval_and_most_of_it_the_whole(head: prs.Machine) -> None:
    for upto, periodic in ((0.5 * TURN, False), (0.9 * TURN, True)):
        found = shape(head, nutation=np.linspace(0.0, 0.5, 40), precession=np.linspace(0.1, upto, 90))
        assert found.periodic == (False, periodic)
        assert (found.mirror is not None) == periodic
        assert found.bounds[1, 1] == pytest.approx(0.1 + TURN if periodic else upto)


def test_nothing_is_mirrored_because_its_names_suggest_it(table: prs.Machine) -> None:
    """x and phi of a machine are no radius and angle: at -x it stands elsewhere than half a turn on."""
    found = shape(table, x=np.linspace(0.0, 0.5, 40), phi=np.linspace(0.0, TURN, 90))
    assert found.periodic == (False, True)
    assert found.mirror is None
    assert found.fixed[1] == table.reference_pose["y"]


def test_a_length_is_never_periodic(table: prs.Machine) -> None:
    found = shape(table, x=np.linspace(-0.5, 0.5, 40), y=np.linspace(-0.5, 0.6, 40))
    assert found.periodic == (False, False)
    assert found.bounds.tolist() == [[-0.5, 0.5], [-0.5, 0.6]]


def test_lines_of_nodes_run_along_one_coordinate(table: prs.Machine) -> None:
    found = shape(table, x=np.linspace(-0.5, 0.5, 40), y=np.linspace(-0.5, 0.6, 40))
    axis, poses = found.line(0, 9)
    assert poses.shape == (1, 9, 3)
    np.testing.assert_array_equal(poses[0, :, 0], axis.nodes)
    assert (poses[0, :, 1] == 0.6).all()
    assert (poses[0, :, 2] == 0.0).all()


def test_of_three_coordinates_lines_run_through_both_ends_of_the_others(table: prs.Machine) -> None:
    found = shape(table, x=np.linspace(-0.5, 0.5, 9), y=np.linspace(-0.5, 0.6, 9), phi=np.linspace(0.0, 1.0, 9))
    _, poses = found.line(0, 5)
    corners = [(-0.5, 0.0), (-0.5, 1.0), (0.6, 0.0), (0.6, 1.0)]
    assert sorted({(float(line[0, 1]), float(line[0, 2])) for line in poses}) == corners


def test_a_list_has_no_given_values(table: prs.Machine) -> None:
    points = np.column_stack([np.tile([0.1, 0.2], 20), np.linspace(0.0, 1.0, 40), np.zeros(40)])
    found = shape(table, points)
    assert found.columns == (0, 1)
    assert [axis.kind for axis in found.box((5, 5)).axes] == ["chebyshev", "chebyshev"]
