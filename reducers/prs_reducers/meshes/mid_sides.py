"""Ten-node tetrahedra that fit together: neighbours share the mid-side nodes of their common edges."""

from __future__ import annotations

import numpy as np

from prs_model.arrays import IntArray

EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))  # of mid-side nodes 4..9, in VTK's order


def check_mid_sides(elements: IntArray) -> None:
    """elements (e, 10). Raises ValueError when an edge has two mid-side nodes, or such a node is of two edges."""
    corners, middles = elements[:, :4], elements[:, 4:].ravel()
    ends = np.sort(corners[:, np.array(EDGES)].reshape(-1, 2), axis=1)
    keys = ends[:, 0] * (elements.max() + 1) + ends[:, 1]
    edges, first, place = np.unique(keys, return_index=True, return_inverse=True)
    other = np.flatnonzero(middles != middles[first][place])
    if len(other):
        here, there = _element(other[0]), _element(first[place[other[0]]])
        raise ValueError(f"elements {there} and {here} have different mid-side nodes on a common edge")
    once, where = np.unique(middles[first], return_index=True)
    if len(once) < len(edges):
        twice = np.setdiff1d(np.arange(len(edges)), where)[0]
        raise ValueError(f"element {_element(first[twice])} has a mid-side node that is one of another edge too")
    if len(both := np.intersect1d(once, corners)):
        at = _element(np.flatnonzero(middles == both[0])[0])
        raise ValueError(f"element {at} has a mid-side node that is a corner too")


def _element(entry: int) -> int:
    return int(entry) // 6 + 1
