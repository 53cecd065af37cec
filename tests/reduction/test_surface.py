"""The decimated skin: few points, closed enough to look at, moving as the part does."""

import numpy as np
import pytest

from prs_model.description.schema import Interface
from prs_model.finite_elements.rigid_motion import transfer
from prs_model.reduction.from_model import reduce_model
from prs_model.reduction.recipe import Settings
from prs_model.reduction.surface import decimate
from tests.meshes import box, steel


def area(points: np.ndarray, triangles: np.ndarray) -> float:
    a, b, c = (points[triangles[:, i]] for i in range(3))
    return float(np.linalg.norm(np.cross(b - a, c - a), axis=1).sum() / 2.0)


def test_surface_follows_a_rigid_motion():
    model = steel(box((0.4, 0.1, 0.08), (8, 2, 2)))
    element = reduce_model(model, {"a": Interface(set="x0")}, Settings("rigid", "joint", 2))
    surface = element.surface
    moved = np.einsum("pin,nm->pim", surface.recovery, element.rigid_body_modes())
    assert moved == pytest.approx(transfer(surface.points)[:, :3], abs=1e-6)
    assert area(surface.points, surface.triangles) == pytest.approx(2 * (0.04 + 0.032 + 0.008), rel=1e-9)


def test_a_fine_surface_is_thinned_out():
    model = steel(box((0.5, 0.5, 0.05), (24, 24, 2), quadratic=False))
    surface = decimate(model, np.eye(model.size)[:, :6], most_triangles=400)
    assert len(surface.triangles) <= 400
    assert surface.triangles.max() == len(surface.points) - 1
    assert surface.recovery.shape == (len(surface.points), 3, 6)
    assert area(surface.points, surface.triangles) == pytest.approx(2 * (0.25 + 0.025 + 0.025), rel=0.01)
