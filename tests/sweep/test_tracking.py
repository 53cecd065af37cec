"""Modes followed on surfaces that are known: through crossings, past gaps, with pairs that stay together."""

from __future__ import annotations

import numpy as np
import pytest

from prs_model.sweep.poses import Poses
from prs_model.sweep.tracking import follow


def _solved(matrices):
    """Frequencies (N, p) and vectors (N, p, p) of symmetric matrices (N, p, p)."""
    return np.linalg.eigh(matrices)


def _crossing(x, y):
    """Three modes that do not feel each other: a rising, a falling and a level one, which cross."""
    levels = np.stack([10.0 + x, 12.0 - x + 0.3 * y, np.full_like(x, 11.5)], axis=-1)
    return levels, levels[..., None] * np.eye(3)


def _grid(nx=21, ny=9):
    axes = np.linspace(0.0, 3.0, nx), np.linspace(0.0, 1.0, ny)
    poses = Poses(("x", "y"), axes)
    return poses, *_crossing(*poses.block(0, poses.size).T)


def test_surfaces_pass_through_crossings():
    poses, levels, matrices = _grid()
    found = follow(poses, np.zeros(2), *_solved(matrices), 3)
    order = np.argsort(levels[found.start])
    np.testing.assert_allclose(found.frequency, levels[:, order])
    assert found.overlap.min() == 1.0
    assert found.identity[0].tolist() == [1, 2, 3]
    assert len(np.unique(found.identity, axis=0)) > 2


def test_a_mode_that_leaves_the_lowest_keeps_its_surface():
    poses, levels, matrices = _grid()
    found = follow(poses, np.zeros(2), *_solved(matrices), 1)
    np.testing.assert_allclose(found.frequency[:, 0], levels[:, 0])
    assert found.identity.max() == 3


def test_unreachable_poses_are_passed_by_and_islands_are_told():
    poses, levels, matrices = _grid()
    x = poses.block(0, poses.size)[:, 0]
    frequencies, vectors = _solved(matrices)
    wall = np.isclose(x, x[9 * 10])
    gap = wall & (poses.block(0, poses.size)[:, 1] > 0.4)
    for missing, beyond in ((gap, False), (wall, True)):
        frequencies[missing], vectors[missing] = np.nan, np.nan
        found = follow(poses, np.zeros(2), frequencies, vectors, 3)
        far = x > x[9 * 10] + 1e-9
        assert (found.identity[far] == 0).all() == beyond
        assert np.isnan(found.frequency[missing]).all()
        assert found.identity[missing].max() == 0
    near = x < x[9 * 10] - 1e-9
    np.testing.assert_allclose(found.frequency[near], levels[near][:, np.argsort(levels[0])])


def test_a_repeated_pair_keeps_its_order_whatever_its_vectors_are():
    poses = Poses(("x",), (np.linspace(0.0, 1.0, 30),))
    x = poses.axes[0]
    rng = np.random.default_rng(2)
    frequencies = np.column_stack([5.0 + x, 5.0 + x, 7.0 - x])
    vectors = np.tile(np.eye(3), (30, 1, 1))
    for i in range(30):
        vectors[i, :2, :2] = np.linalg.qr(rng.normal(size=(2, 2)))[0]
    order = np.argsort(frequencies, axis=1, kind="stable")
    frequencies = np.take_along_axis(frequencies, order, axis=1)
    vectors = np.take_along_axis(vectors, order[:, None], axis=2)
    found = follow(poses, np.zeros(1), frequencies, vectors, 3)
    np.testing.assert_allclose(found.frequency[:, 2], 7.0 - x)
    assert found.overlap.min() == pytest.approx(1.0)


def test_a_list_is_followed_from_neighbour_to_neighbour():
    points = np.random.default_rng(3).uniform([0.0, 0.0], [3.0, 1.0], size=(400, 2))
    levels, matrices = _crossing(*points.T)
    found = follow(Poses(("x", "y"), (), points), np.zeros(2), *_solved(matrices), 3)
    np.testing.assert_allclose(found.frequency, levels[:, np.argsort(levels[found.start])])


def test_round_a_conical_intersection_the_overlap_warns():
    """[[x, y], [y, -x]]: the modes meet at one point, and rows near it step over what rows further off resolve."""
    poses = Poses(("x", "y"), (np.linspace(-1.0, 1.0, 16), np.linspace(-1.0, 1.0, 16)))
    x, y = poses.block(0, poses.size).T
    matrices = np.array([[x, y], [y, -x]]).transpose(2, 0, 1) + 10.0 * np.eye(2)
    found = follow(poses, np.array([-1.0, -1.0]), *_solved(matrices), 2)
    surfaces = found.frequency.reshape(16, 16, 2)
    assert np.abs(np.diff(surfaces, axis=0)).max() < 0.5
    assert found.overlap.min() < 0.95


def test_no_reachable_pose_leaves_nothing_to_follow():
    poses, levels, matrices = _grid()
    listed = Poses(poses.names, (), poses.block(0, poses.size))
    for each in (poses, listed):
        found = follow(each, np.zeros(2), np.full_like(levels, np.nan), np.full_like(matrices, np.nan), 2)
        assert found.start is None
        assert (found.identity == 0).all()
        assert np.isnan(found.frequency).all()


def test_poses_listed_many_times_are_followed_like_those_listed_once():
    poses, levels, matrices = _grid(31, 1)
    copies = np.repeat(np.arange(31), 12)
    listed = Poses(poses.names, (), poses.block(0, poses.size)[copies])
    frequencies, vectors = _solved(matrices)
    once = follow(Poses(poses.names, (), poses.block(0, 31)), np.zeros(2), frequencies, vectors, 3)
    found = follow(listed, np.zeros(2), frequencies[copies], vectors[copies], 3)
    assert found.identity.min() == 1
    np.testing.assert_array_equal(found.identity, once.identity[copies])
    np.testing.assert_allclose(found.frequency, levels[copies][:, np.argsort(levels[0])])


def test_groups_of_listed_poses_are_joined_at_their_nearest():
    """Clouds of poses further from each other than from their own, along a curve on which modes cross."""
    scatter = np.random.default_rng(3).normal(scale=1e-4, size=(9, 15, 2))
    points = (np.column_stack([np.linspace(0.0, 3.0, 9), np.zeros(9)])[:, None] + scatter).reshape(-1, 2)
    levels, matrices = _crossing(*points.T)
    found = follow(Poses(("x", "y"), (), points), np.zeros(2), *_solved(matrices), 3)
    assert found.overlap.min() > 0.999
    np.testing.assert_allclose(found.frequency, levels[:, np.argsort(levels[found.start])])
