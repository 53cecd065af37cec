"""What a sweep is asked: grids, lists, and sentences for what cannot be meant."""

from __future__ import annotations

import numpy as np
import pytest

from prs_model import load_machine
from prs_model.errors import PrsError
from prs_model.sweep.poses import poses_of
from prs_model.sweep.request import Request


@pytest.fixture(scope="module")
def head():
    return load_machine("head_3prs")


def test_a_grid_is_numbered_in_c_order(head):
    poses = poses_of(head, {"precession": [0.0, 1.0, 2.0], "nutation": (0.1, 0.2)})
    assert poses.shape == (2, 3, 1)
    everything = poses.block(0, 100)
    assert everything[4].tolist() == [0.2, 1.0, head.reference_pose["z"]]
    np.testing.assert_array_equal(np.vstack([poses.block(0, 4), poses.block(4, 6)]), everything)
    assert poses.varying() == (0, 1)


def test_a_list_keeps_its_order_and_is_a_copy(head):
    points = np.array([[0.1, 0.0, 1.2], [0.0, 3.0, 1.2]])
    poses = poses_of(head, {}, points)
    points[:] = 0.0
    assert poses.shape == (2,)
    assert not poses.is_grid
    assert poses.block(1, 2).tolist() == [[0.0, 3.0, 1.2]]


@pytest.mark.parametrize(
    ("coordinates", "poses", "words"),
    [
        ({"nutatoin": 0.1}, None, "known: nutation, precession, z"),
        ({"nutation": []}, None, "nutation: found an empty list"),
        ({"nutation": [[0.0]]}, None, r"nutation: found an array of shape \(1, 1\)"),
        ({"nutation": [0.0, np.nan]}, None, "nutation: found nan at place 1"),
        ({"nutation": ["a"]}, None, "nutation: found no array of numbers"),
        ({"nutation": [True]}, None, "nutation: found no array of numbers"),
        ({"z": 1.2}, [[0.0, 0.0, 1.2]], "found a list of poses and values of z"),
        ({}, [[0.0, 0.0]], r"poses: found an array of shape \(1, 2\), expected \(N, 3\)"),
        ({}, [[0.0, 0.0, np.inf]], "found inf for z of pose 0"),
    ],
)
def test_wrong_poses_are_told_in_a_sentence(head, coordinates, poses, words):
    with pytest.raises(PrsError, match=words):
        poses_of(head, coordinates, poses)


def test_frequencies_always_come_along_and_quantities_have_one_order():
    assert Request(quantities=("static_compliance",)).quantities == ("frequency", "static_compliance")
    assert Request(quantities="identity") == Request(quantities=["identity", "frequency"])


@pytest.mark.parametrize(
    ("entries", "words"),
    [
        ({"n_modes": 0}, "n_modes: found 0"),
        ({"n_modes": 2.0}, "n_modes: found 2.0"),
        ({"quantities": ("frequnecy",)}, "unknown quantity 'frequnecy'; known: frequency, static_compliance"),
        ({"quantities": 3}, "quantities: found 3"),
        ({"tolerance": 0.1}, "tolerance: found 0.1, expected a number between 1e-12 and 0.01"),
        ({"tolerance": float("nan")}, "tolerance: found nan"),
        ({"quantities": ("frf_peak",)}, "band: found none"),
        ({"band": (5.0, 5.0)}, r"band: found \(5.0, 5.0\)"),
        ({"band": 5.0}, "band: found 5.0"),
    ],
)
def test_wrong_requests_are_told_in_a_sentence(entries, words):
    with pytest.raises(PrsError, match=words):
        Request(**entries)
