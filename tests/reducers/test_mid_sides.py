"""Neighbouring ten-node tetrahedra share the mid-side nodes of their edges, or the mesh is refused."""

from dataclasses import replace

import numpy as np
import pytest

import prs_model as prs
from prs_reducers.meshes.mid_sides import check_mid_sides
from tests.meshes import box, steel


def test_a_mid_side_node_of_its_own_is_a_crack() -> None:
    """The second point stands where the first does, so that no element is bent."""
    mesh = box((0.2, 0.1, 0.1), (2, 1, 1))
    elements = mesh.elements.copy()
    points = np.vstack([mesh.points, mesh.points[elements[0, 6]]])
    elements[0, 6] = len(mesh.points)
    assert steel(mesh).size == 3 * len(mesh.points)
    with pytest.raises(prs.PartFileError, match="different mid-side nodes on a common edge"):
        steel(replace(mesh, points=points, elements=elements))


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        ([0, 1, 2, 3, 4, 5, 6, 7, 8, 4], "element 1 has a mid-side node that is one of another edge too"),
        ([0, 1, 2, 3, 4, 5, 6, 7, 8, 0], "element 1 has a mid-side node that is a corner too"),
    ],
)
def test_a_mid_side_node_belongs_to_one_edge(wrong: list[int], message: str) -> None:
    check_mid_sides(np.arange(10).reshape(1, 10))
    with pytest.raises(ValueError, match=message):
        check_mid_sides(np.array([wrong]))
