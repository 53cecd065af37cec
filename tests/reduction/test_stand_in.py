"""What stands for a part that has no surface."""

import numpy as np
import pytest

import prs_model as prs
from prs_model.reduction import SuperElement
from prs_model.reduction.stand_in import stand_in


def test_stand_in_moves_with_its_part_and_weighs_the_same() -> None:
    """A rigid part: every drawn point follows the rigid motion, and the cuboid has the moments of inertia."""
    element = prs.load_machine("hexapod").parts["platform"]
    assert isinstance(element, SuperElement)
    surface = stand_in(element, thickness=1e-4)
    twist = np.array([0.1, -0.2, 0.3, 0.4, 0.5, -0.6])
    moved = surface.recovery @ (element.rigid_body_modes() @ twist)
    assert moved == pytest.approx(twist[:3] + np.cross(twist[3:], surface.points), abs=1e-6)
    properties = element.mass_properties()
    edges = np.ptp(surface.points[:8], axis=0)
    moments = properties.mass / 12.0 * (np.sum(edges**2) - edges**2)
    assert moments == pytest.approx(np.diag(properties.inertia), rel=1e-6)
    assert surface.points[:8].mean(axis=0) == pytest.approx(properties.centre, abs=1e-9)
