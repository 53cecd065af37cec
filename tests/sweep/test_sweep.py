"""Machine.sweep against the machine's modes at each pose: within its own bounds, and these within the tolerance."""

from __future__ import annotations

import numpy as np
import pytest
import xarray

import prs_model as prs
from prs_model.errors import PrsError
from prs_model.sweep.request import Request
from prs_model.sweep.truth import at_pose

TURN = 2.0 * np.pi
SHARES = ("static_compliance", "flexibility_share", "kinetic_energy", "strain_energy")


@pytest.fixture(scope="module")
def head() -> prs.Machine:
    return prs.load_machine("head_3prs")


@pytest.fixture(scope="module")
def hexapod() -> prs.Machine:
    return prs.load_machine("hexapod")


@pytest.fixture(scope="module")
def round_trip(head: prs.Machine) -> xarray.Dataset:
    return head.sweep(nutation=np.linspace(0.0, 0.5, 12), precession=np.linspace(0.0, TURN, 121), tolerance=1e-4)


@pytest.fixture(scope="module")
def volume(hexapod: prs.Machine) -> xarray.Dataset:
    return hexapod.sweep(**corner(18), tolerance=1e-4)


def corner(count: int) -> dict[str, np.ndarray]:
    """A part of the hexapod's space of which struts do not reach the upper end."""
    return {"x": np.linspace(0.0, 3e-3, count), "z": np.linspace(0.1, 0.112, count), "ry": np.linspace(0, 0.05, count)}


def assert_within_bounds(machine: prs.Machine, data: xarray.Dataset, count: int, tolerance: float) -> None:
    """The frequencies of some reachable poses, at random, against machine.modes."""
    flat = data.stack(each=[dim for dim in data["reason"].dims])
    there = np.flatnonzero(flat["reason"].values == 0)
    for i in np.random.default_rng(12).choice(there, count, replace=False):
        one = flat.isel(each=i)
        exact = machine.modes(data.sizes["mode"], **{name: float(one[name]) for name in machine.pose_names}).frequencies
        errors = np.abs(one["frequency"].values / exact - 1.0)
        assert (errors <= one["bound"].values + 1e-11).all()
        assert (one["bound"].values <= tolerance).all()


def test_a_map_of_the_head_is_within_its_bounds(head: prs.Machine, round_trip: xarray.Dataset) -> None:
    assert round_trip["frequency"].dims == ("nutation", "precession", "mode")
    assert (round_trip["proof"] == 1).all()
    assert round_trip.attrs["certificate_poses_interpolated"] == round_trip["proof"].size
    assert_within_bounds(head, round_trip, 12, 1e-4)


def test_a_turn_ends_where_it_began(round_trip: xarray.Dataset) -> None:
    frequency = round_trip["frequency"]
    np.testing.assert_allclose(frequency[:, 0], frequency[:, -1], rtol=1e-10)
    np.testing.assert_allclose(frequency[0], np.broadcast_to(frequency[0, 0], frequency[0].shape), rtol=1e-4)


def test_a_volume_without_closed_form_is_within_its_bounds(hexapod: prs.Machine, volume: xarray.Dataset) -> None:
    assert (volume["proof"] != 2).all()
    assert_within_bounds(hexapod, volume, 25, 1e-4)


def test_poses_out_of_reach_have_a_reason_and_others_are_untouched(
    hexapod: prs.Machine, volume: xarray.Dataset
) -> None:
    """Exactly those that the kinematics refuses, for the reason it gives."""
    reason = volume["reason"].values
    assert 0 < (reason > 0).sum() < reason.size / 2
    assert np.array_equal(np.isnan(volume["frequency"].values).all(axis=-1), reason > 0)
    assert np.array_equal(volume["proof"].values == 0, reason > 0)
    poses = np.tile(list(hexapod.reference_pose.values()), (reason.size, 1))
    mesh = np.meshgrid(*corner(18).values(), indexing="ij")
    for name, values in zip(corner(18), mesh, strict=True):
        poses[:, hexapod.pose_names.index(name)] = values.ravel()
    exact = hexapod.kinematics.solve_batch(poses)
    assert np.array_equal(exact.reachable, reason.ravel() == 0)
    words = dict(
        zip(volume["reason"].attrs["flag_values"], volume["reason"].attrs["flag_meanings"].split(), strict=True)
    )
    for code in np.unique(reason[reason > 0]):
        joint, limit = str(words[code]).split("_above_its_upper_limit_")
        values = exact.q[reason.ravel() == code, hexapod.kinematics.tree.names.index(joint)]
        assert limit == "110_mm"
        assert values.min() > 0.11


def test_a_tighter_tolerance_takes_more_nodes_and_holds(hexapod: prs.Machine) -> None:
    nodes = []
    for tolerance in (1e-4, 1e-8):
        data = hexapod.sweep(x=np.linspace(-0.003, 0.003, 25), rz=np.linspace(-0.05, 0.05, 25), tolerance=tolerance)
        assert (data["proof"] == 1).all()
        assert_within_bounds(hexapod, data, 15, tolerance)
        nodes.append(int(data.attrs["certificate_how"].split()[0]))
    assert nodes[0] < nodes[1]


def test_a_list_has_the_values_of_the_grid(head: prs.Machine, round_trip: xarray.Dataset) -> None:
    nutation, precession = np.meshgrid(round_trip["nutation"], round_trip["precession"], indexing="ij")
    points = np.column_stack([nutation.ravel(), precession.ravel(), np.full(nutation.size, float(round_trip["z"]))])
    order = np.random.default_rng(13).permutation(len(points))
    listed = head.sweep(poses=points[order], tolerance=1e-4)
    assert listed["frequency"].dims == ("pose", "mode")
    expected = round_trip["frequency"].values.reshape(-1, 6)[order]
    both = listed["bound"].values + round_trip["bound"].values.reshape(-1, 6)[order]
    assert (np.abs(listed["frequency"].values / expected - 1.0) <= both + 1e-12).all()


def test_one_pose(hexapod: prs.Machine) -> None:
    one = hexapod.sweep(x=0.001)
    assert one["frequency"].dims == ("mode",)
    np.testing.assert_allclose(one["frequency"], hexapod.modes(6, x=0.001).frequencies, rtol=1e-10)


def test_a_line_and_a_list_of_few(hexapod: prs.Machine) -> None:
    line = hexapod.sweep(x=[0.002, 0.0, 0.001], n_modes=3)
    assert line["frequency"].sizes == {"x": 3, "mode": 3}
    np.testing.assert_allclose(line["frequency"][2], hexapod.modes(3, x=0.001).frequencies, rtol=1e-10)
    assert (line["proof"] == 2).all()
    listed = hexapod.sweep(poses=[list(hexapod.reference_pose.values())])
    np.testing.assert_allclose(listed["frequency"][0], hexapod.modes(6).frequencies, rtol=1e-10)


def test_a_long_line_is_interpolated(hexapod: prs.Machine) -> None:
    line = hexapod.sweep(rz=np.linspace(-0.05, 0.05, 500), n_modes=4)
    assert (line["proof"] == 1).all()
    assert_within_bounds(hexapod, line, 15, 1e-6)


def test_values_may_come_in_any_order_and_more_than_once(hexapod: prs.Machine) -> None:
    up = np.linspace(-0.05, 0.05, 200)
    mixed = np.concatenate([up[::-1], up[50:60], up])
    there, back = hexapod.sweep(rz=np.tile(up, 3), n_modes=4), hexapod.sweep(rz=mixed, n_modes=4)
    np.testing.assert_allclose(back["frequency"][:200], there["frequency"][:200][::-1], rtol=1e-9)
    np.testing.assert_allclose(back["frequency"][-200:], there["frequency"][200:400], rtol=1e-9)


def test_what_else_is_asked_for_agrees_with_the_truth(hexapod: prs.Machine) -> None:
    grid = {"x": np.linspace(-0.002, 0.002, 25), "ry": np.linspace(0.01, 0.05, 25)}
    data = hexapod.sweep(**grid, quantities=SHARES, tolerance=1e-8)
    assert (data["proof"] == 1).all()
    for i, j in ((0, 0), (3, 17), (20, 9)):
        one = data.isel(x=i, ry=j)
        at = hexapod.configuration(x=float(one["x"]), ry=float(one["ry"]))
        truth = at_pose(hexapod, at, Request(quantities=SHARES))
        for name in SHARES:
            size = np.abs(truth[name]).max()
            np.testing.assert_allclose(one[name], truth[name][0], rtol=1e-5, atol=1e-6 * size)


def test_progress_is_told_and_ends_at_the_total(hexapod: prs.Machine) -> None:
    told: list[tuple[int, int]] = []
    grid = {"x": np.linspace(-0.003, 0.003, 200), "rz": np.linspace(-0.05, 0.05, 200)}
    data = hexapod.sweep(**grid, progress=lambda done, size: told.append((done, size)))
    assert told[-1] == (data["reason"].size, data["reason"].size)
    assert {size for _, size in told} == {data["reason"].size}
    assert told == sorted(told)


@pytest.mark.parametrize(
    "count",
    [2, 500],
)
def test_more_modes_than_there_are_are_told(hexapod: prs.Machine, count: int) -> None:
    with pytest.raises(PrsError, match=r"n_modes: found 9, expected at most 6"):
        hexapod.sweep(x=np.linspace(-0.003, 0.003, count), n_modes=9)


@pytest.mark.parametrize("count", [3, 450])
def test_a_map_without_a_reachable_pose_says_so(hexapod: prs.Machine, count: int) -> None:
    z = np.linspace(3.0, 4.0, count)
    points = np.tile(list(hexapod.reference_pose.values()), (count, 1))
    points[:, 2] = z
    for data in (hexapod.sweep(z=z, quantities="identity"), hexapod.sweep(poses=points, quantities="identity")):
        assert (data["reason"] > 0).all()
        assert np.isnan(data["tracked_frequency"]).all()
        assert (data["identity"] == 0).all()
        assert data["character"].values.tolist() == ["unknown"] * 6
        assert "no pose is reachable" in data["identity"].attrs["comment"]
        assert data.attrs["certificate_poses_unreachable"] == count
        assert "certificate_relative_error_bound" not in data.attrs
