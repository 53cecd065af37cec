"""Which mode a frequency belongs to, followed from pose to pose through crossings.

Modes of neighbouring poses are compared by the squared cosine of their vectors (eq. 23), in a frame that turns
smoothly with the pose. Identities start where the sweep is nearest the reference pose and spread along a tree over all
poses: the spanning tree whose steps have the best overlaps, along the rows of a grid where they are equally good. On a
grid steps lead to neighbours only, and islands are not reached; in a list they lead to the nearest poses, however far.

A pose where two frequencies are one has arbitrary vectors: the tree passes it by and reaches it last.
Round a point where two frequencies meet (a conical intersection) no labelling is both smooth and single-valued on a
grid that steps over the meeting in some rows and resolves it in others: there the tree leaves a seam, at its weakest
steps. `overlap` says how far each label is to be trusted.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import linear_sum_assignment
from scipy.sparse import coo_array, csr_array
from scipy.sparse.csgraph import breadth_first_order, connected_components, minimum_spanning_tree
from scipy.spatial import cKDTree

from ..arrays import BoolArray, FloatArray, IntArray
from .poses import Poses

_REPEATED = 1e-6  # relative distance of frequencies that count as one
_ORDER = 1e-6  # what keeping the order is worth beside overlap, which settles ties
_CLASSES = 20  # of overlap, within which the tree follows rows
_NEIGHBOURS = 6  # of a pose in a list
_CHUNK = 20_000  # steps compared at once, to bound memory


@dataclass(frozen=True, eq=False)
class Identities:
    """Modes followed over N poses, numbered from 1 in the order of frequencies at pose number `start`, if there is one.

    identity (N, k): whose the i-th frequency is, 0 where nothing led to the pose. frequency (N, k) [Hz] of each
    identity, NaN there. overlap (N, k): the least squared cosine of a step on the way, of each identity.
    """

    start: int | None
    identity: NDArray[np.int16]
    frequency: FloatArray
    overlap: FloatArray


def follow(poses: Poses, reference: FloatArray, frequencies: FloatArray, vectors: FloatArray, count: int) -> Identities:
    """The identities of `count` modes, from all frequencies (N, p) [Hz] and vectors (N, q, p) of a frame.

    reference: the pose (d,) that the start is nearest to. NaN marks poses that are unreachable. Poses that are listed
    several times have the identities of the first of them.
    """
    there = np.asarray(np.isfinite(frequencies).all(axis=1))
    if not there.any():
        return followed_nowhere(poses.size, count)
    if poses.points is not None:
        points, first, copies = np.unique(poses.points, axis=0, return_index=True, return_inverse=True)
        if len(points) < poses.size:
            distinct = Poses(poses.names, (), points)
            found = follow(distinct, reference, frequencies[first], vectors[first], count)
            return _spread(found, first, copies.reshape(-1))
    start = _start(poses, reference, there)
    if poses.is_grid:
        edges, preference = _grid_edges(poses, start, _has_repeated(frequencies))
    else:
        edges, preference = _list_edges(poses, there)
    usable = there[edges].all(axis=1)
    edges, preference = edges[usable], preference[usable]
    partners, overlaps = _steps(edges, frequencies, vectors)
    costs = _costs(edges, preference, overlaps, _has_repeated(frequencies))
    before, step = _tree(edges, costs, start, poses.size)
    place, least, reached = _along(before, step, edges, partners, overlaps, start)
    identity = np.argsort(place, axis=1)[:, :count] + 1
    followed = np.take_along_axis(frequencies, place, axis=1)[:, :count]
    return Identities(
        start,
        np.where(reached[:, None], identity, 0).astype(np.int16),
        np.where(reached[:, None], followed, np.nan),
        np.where(reached[:, None], least[:, :count], np.nan),
    )


def followed_nowhere(size: int, count: int) -> Identities:
    """No identity at any of `size` poses, where none is reachable."""
    nothing = np.full((size, count), np.nan)
    return Identities(None, np.zeros((size, count), dtype=np.int16), nothing, nothing.copy())


def _spread(found: Identities, first: IntArray, copies: IntArray) -> Identities:
    """The identities of all poses from those of distinct ones: which stand `first` there, and what each is one of."""
    start = None if found.start is None else int(first[found.start])
    return Identities(start, found.identity[copies], found.frequency[copies], found.overlap[copies])


def _start(poses: Poses, reference: FloatArray, there: BoolArray) -> int:
    """The reachable pose nearest the reference, coordinates measured by their range."""
    every = poses.block(0, poses.size)
    away = (every - reference) / np.maximum(np.ptp(every, axis=0), np.finfo(float).eps)
    distance = np.where(there, np.linalg.norm(away, axis=1), np.inf)
    return int(np.argmin(distance))


def _grid_edges(poses: Poses, start: int, has_repeated: BoolArray) -> tuple[IntArray, FloatArray]:
    """Pairs of neighbours (e, 2), and what each costs: rows of the last axis least, others least near the start.

    Where a pose has repeated frequencies, its two neighbours along each axis are a pair too.
    """
    numbers = np.arange(poses.size).reshape(poses.shape)
    edges = []
    for axis in range(len(poses.shape)):
        row = np.moveaxis(numbers, axis, -1)
        near = np.column_stack([row[..., :-1].ravel(), row[..., 1:].ravel()])
        apart = np.column_stack([row[..., :-2].ravel(), row[..., 2:].ravel()])
        edges += [near, apart[has_repeated[row[..., 1:-1].ravel()]]]
    costs = [_along_cost(poses, start, k // 2, pairs) for k, pairs in enumerate(edges)]
    return np.vstack([np.zeros((0, 2), dtype=np.intp), *edges]), np.concatenate([np.zeros(0), *costs])


def _along_cost(poses: Poses, start: int, axis: int, pairs: IntArray) -> FloatArray:
    """Below 1: more for earlier axes, and for those away from the start along later ones."""
    places, here = np.unravel_index(pairs[:, 0], poses.shape), np.unravel_index(start, poses.shape)
    later = range(axis + 1, len(poses.shape))
    away = sum((np.abs(places[k] - here[k]) / poses.shape[k] for k in later), np.zeros(len(pairs)))
    return np.asarray((len(later) + away / max(len(later), 1)) / (len(poses.shape) + 1))


def _list_edges(poses: Poses, there: BoolArray) -> tuple[IntArray, FloatArray]:
    """Each reachable pose of a list with those nearest to it (e, 2), coordinates by their range, and distances < 1.

    Groups that are apart are joined by the pair of poses that are nearest, until all poses hang together.
    """
    numbers = np.flatnonzero(there)
    points = poses.block(0, poses.size)[numbers]
    points = points / np.maximum(np.ptp(points, axis=0), np.finfo(float).eps)
    count = min(_NEIGHBOURS + 1, len(numbers))
    distances, nearest = cKDTree(points).query(points, k=range(1, count + 1))
    pairs = np.column_stack([np.repeat(np.arange(len(numbers)), count), nearest.ravel()])
    pairs, first = np.unique(np.sort(pairs, axis=1), axis=0, return_index=True)
    own = pairs[:, 0] != pairs[:, 1]
    pairs, distance = pairs[own], np.asarray(distances).ravel()[first][own]
    while True:
        links = coo_array((np.ones(len(pairs)), pairs.T), shape=(len(numbers), len(numbers)))
        groups, group = connected_components(links, directed=False)
        if groups == 1:
            return numbers[pairs], distance / (1.0 + distance)
        bridges, lengths = _bridges(points, np.asarray(group, dtype=np.intp))
        pairs, distance = np.vstack([pairs, bridges]), np.concatenate([distance, lengths])


def _bridges(points: FloatArray, group: IntArray) -> tuple[IntArray, FloatArray]:
    """The pairs (b, 2) of points (N, d) that are nearest between each group (N,) and all others, and their distances.

    Numbers of two groups differ in a digit at least: for each binary digit points of either kind look for the other.
    """
    nearest, distance = np.zeros(len(group), dtype=np.intp), np.full(len(group), np.inf)
    for digit in range(int(group.max()).bit_length()):
        is_one = (group >> digit) % 2 == 1
        ones, zeros = np.flatnonzero(is_one), np.flatnonzero(~is_one)
        for own, others in ((ones, zeros), (zeros, ones)):
            away, place = map(np.asarray, cKDTree(points[others]).query(points[own]))
            closer = away < distance[own]
            distance[own[closer]], nearest[own[closer]] = away[closer], others[place[closer]]
    order = np.lexsort((distance, group))
    ends = order[np.unique(group[order], return_index=True)[1]]
    pairs, first = np.unique(np.sort(np.column_stack([ends, nearest[ends]]), axis=1), axis=0, return_index=True)
    return pairs, distance[ends][first]


def _steps(edges: IntArray, frequencies: FloatArray, vectors: FloatArray) -> tuple[NDArray[np.int16], FloatArray]:
    """For each step a -> b: the mode at b that each mode at a becomes (e, p), and their overlap (e, p)."""
    size = frequencies.shape[1]
    partners, overlaps = np.empty((len(edges), size), dtype=np.int16), np.empty((len(edges), size))
    for begin in range(0, len(edges), _CHUNK):
        some = slice(begin, begin + _CHUNK)
        a, b = edges[some].T
        cosines = vectors[a].swapaxes(1, 2) @ vectors[b]
        likeness = _merged(cosines**2, frequencies[a], frequencies[b])
        partners[some] = _assigned(likeness)
        overlaps[some] = np.take_along_axis(likeness, partners[some, :, None].astype(np.intp), axis=2)[:, :, 0]
    return partners, overlaps


def _merged(likeness: FloatArray, frequencies_a: FloatArray, frequencies_b: FloatArray) -> FloatArray:
    """Overlaps (e, p, p) with those of repeated frequencies, whose vectors are arbitrary, replaced by their spaces'."""
    same_a, same_b = _repeated(frequencies_a), _repeated(frequencies_b)
    some = np.flatnonzero((same_a.sum(axis=(1, 2)) + same_b.sum(axis=(1, 2))) > 2 * likeness.shape[1])
    if some.size:
        sizes_a, sizes_b = same_a[some].sum(axis=2), same_b[some].sum(axis=2)
        total = same_a[some] @ likeness[some] @ same_b[some]
        likeness[some] = total / np.minimum(sizes_a[:, :, None], sizes_b[:, None])
    return likeness


def _repeated(frequencies: FloatArray) -> FloatArray:
    """(e, p, p): 1 where two frequencies of a pose are one, themselves included, else 0."""
    apart = np.diff(frequencies, axis=1) > _REPEATED * frequencies[:, 1:]
    cluster = np.concatenate([np.zeros((len(apart), 1)), np.cumsum(apart, axis=1)], axis=1)
    return np.asarray(cluster[:, :, None] == cluster[:, None], dtype=float)


def _assigned(likeness: FloatArray) -> NDArray[np.int16]:
    """The partner (e, p) of each mode: the likest, or where two have the same one, all different with the best sum."""
    order = np.arange(likeness.shape[1])
    worth = likeness - _ORDER * (order[:, None] - order) ** 2
    partner = np.argmax(worth, axis=2)
    clash = np.flatnonzero((np.sort(partner, axis=1) != order).any(axis=1))
    for e in clash:
        partner[e] = linear_sum_assignment(worth[e], maximize=True)[1]
    return np.asarray(partner, dtype=np.int16)


def _has_repeated(frequencies: FloatArray) -> BoolArray:
    """Whether two frequencies of a pose are one (N,)."""
    return np.asarray((np.diff(frequencies, axis=1) <= _REPEATED * frequencies[:, 1:]).any(axis=1))


def _costs(edges: IntArray, preference: FloatArray, overlaps: FloatArray, has_repeated: BoolArray) -> FloatArray:
    """What a step costs the tree (e,): its overlap in classes, half of them where vectors are arbitrary, then rows."""
    grades = np.round(_CLASSES * (1.0 - np.clip(overlaps.min(axis=1, initial=1.0), 0.0, 1.0)))
    return np.asarray(1.0 + grades + _CLASSES / 2 * has_repeated[edges].any(axis=1) + preference)


def _tree(edges: IntArray, costs: FloatArray, start: int, count: int) -> tuple[IntArray, IntArray]:
    """The pose before each (N,), itself at the start, -1 where nothing leads; and the number of the edge there (N,)."""
    tree = minimum_spanning_tree(csr_array(coo_array((costs, edges.T), shape=(count, count))))
    before = np.asarray(breadth_first_order(tree, start, directed=False)[1], dtype=np.intp)
    before = np.where(before < 0, -1, before)
    before[start] = start
    child = np.flatnonzero((before >= 0) & (np.arange(count) != start))
    low, high = np.minimum(child, before[child]), np.maximum(child, before[child])
    keys = edges[:, 0] * count + edges[:, 1]
    order = np.argsort(keys)
    step = np.full(count, -1, dtype=np.intp)
    step[child] = order[np.searchsorted(keys, low * count + high, sorter=order)]
    return before, step


def _along(
    before: IntArray, step: IntArray, edges: IntArray, partners: IntArray, overlaps: FloatArray, start: int
) -> tuple[IntArray, FloatArray, BoolArray]:
    """Where each mode of the start is (N, p) at every pose, its least overlap (N, p), and which poses are reached (N,).

    Steps are put together in pairs, pairs of pairs and so on, for all poses at once.
    """
    count, size = len(before), partners.shape[1]
    place, least = np.tile(np.arange(size), (count, 1)), np.ones((count, size))
    child = np.flatnonzero(step >= 0)
    forth = edges[step[child], 0] == before[child]
    there = partners[step[child]].astype(np.intp)
    place[child] = np.where(forth[:, None], there, np.argsort(there, axis=1))
    least[child] = np.where(
        forth[:, None], overlaps[step[child]], np.take_along_axis(overlaps[step[child]], place[child], axis=1)
    )
    ancestor = np.where(before >= 0, before, np.arange(count))
    while True:
        further = ancestor[ancestor]
        if np.array_equal(further, ancestor):
            return place, least, np.asarray((before >= 0) & (ancestor == start))
        way = place[ancestor]
        least = np.minimum(least[ancestor], np.take_along_axis(least, way, axis=1))
        place = np.take_along_axis(place, way, axis=1)
        ancestor = further
