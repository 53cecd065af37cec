"""Frequencies of one part by itself, against springs and masses that anyone can solve."""

from math import pi, sqrt

import numpy as np
import pytest

import prs_model as prs


def chain(stiffness: list[list[float]], mass: list[float], **more: object) -> prs.SuperElement:
    """Coordinates that all move along x; every one is a node of its own."""
    n = len(mass)
    motions = np.zeros((n, 6, n))
    motions[np.arange(n), 0, np.arange(n)] = 1.0
    positions = np.column_stack([np.arange(n), np.zeros((n, 2))])
    names = tuple(f"n{i}" for i in range(n))
    return prs.SuperElement(np.array(stiffness), np.diag(mass), names, positions, motions, **more)


def test_free_frequencies_leave_rigid_motion_out_and_nothing_else():
    """A mass on a spring ten orders softer than the next one is elastic, however high the next frequency."""
    soft, stiff = 1.0, 1e10
    k = [[soft, -soft, 0.0], [-soft, soft + stiff, -stiff], [0.0, -stiff, stiff]]
    found = chain(k, [1.0, 1.0, 1.0]).frequencies(6)
    assert found == pytest.approx([sqrt(1.5 * soft) / (2 * pi), sqrt(2.0 * stiff) / (2 * pi)], rel=1e-5)


def test_a_grounded_part_keeps_its_low_frequencies():
    part = chain([[1.0, 0.0], [0.0, 1e12]], [1.0, 1.0], grounded=True)
    assert part.frequencies(2) == pytest.approx([1.0 / (2 * pi), 1e6 / (2 * pi)])


def test_a_mode_remains_with_the_nodes_held():
    part = chain([[4.0, -4.0], [-4.0, 4.0]], [1.0, 1.0])
    inner = prs.SuperElement(part.stiffness, part.mass, ("n0",), part.positions[:1], part.motions[:1])
    assert inner.frequencies(3, held=True) == pytest.approx([2.0 / (2 * pi)])
    assert part.frequencies(3, held=True).size == 0


def test_a_point_mass_has_no_frequencies_and_says_what_it_is():
    point = prs.reduce("rigid", mass=2.0, nodes={"a": (0.0, 0.0, 0.0)})
    assert point.frequencies(3).size == 0
    assert repr(point) == "SuperElement('rigid', 6 coordinates, nodes a)"
