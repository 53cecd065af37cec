"""Dual systems as the kernels take them: body after body in flat arrays, wrenches in an order of little fill."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ...arrays import FloatArray, IntArray
from ...synthesis.dual import DualSystems
from .kernels_ritz import Packed

_Groups = tuple[tuple[int, ...], ...]
_Indices = NDArray[np.int64]


def packed(dual: DualSystems, shapes: FloatArray, shift: float, at: float) -> Packed:
    """A dual system with shapes V (n, r) on all body coordinates, at a shift [rad^2/s^2].

    Bodies that are the same at all poses are decoupled at another, negative `shift`; `at` may be the same.
    Raises numpy.linalg.LinAlgError where `at` is an eigenvalue of such a body alone.
    """
    q, r = dual.size, shapes.shape[1]
    place, starts, columns = _elimination_of(dual)
    constant, mass = np.zeros((q + r, q + r)), np.zeros((r, r))
    entries, values = [np.zeros((0, 2), dtype=np.int64)], [np.zeros((len(dual), 0))]
    for rows, others, added in dual.entries():
        where = np.sort(np.column_stack([place[rows], place[others]]), axis=1)
        if len(added) == 1:
            np.add.at(constant, tuple(where.T), added[0])
        else:
            entries.append(where)
            values.append(added)
    bodies = list(_bodies(dual, shapes, place, shift, at))
    fixed, moving = ([each for each in bodies if each.follows == follows] for follows in (False, True))
    for each in fixed:
        where, beside = np.arange(q, q + r), each.load
        constant[where[:, None], where] += beside.T @ (beside / each.pivots[:, None])
        mass += each.shapes.T @ each.mass[0] @ each.shapes
    return Packed(
        sizes=np.array([(len(each.rows), len(each.shapes), each.follows) for each in bodies], dtype=np.int64),
        rows=np.concatenate([each.rows for each in bodies]),
        readings=_side_by_side([each.forces for each in bodies], len(dual)),
        roots=_flat([each.root for each in fixed]),
        pivots=_flat([each.pivots for each in fixed]),
        inertias=_flat([each.inertias for each in fixed]),
        loads=_flat([each.load for each in fixed]),
        pencils=_side_by_side([each.stiffness - at * each.mass for each in moving], len(dual)),
        masses=_side_by_side([each.mass for each in moving], len(dual)),
        shapes=_flat([each.shapes for each in moving]),
        entries=np.concatenate(entries),
        values=np.concatenate(values, axis=1),
        starts=starts,
        columns=columns,
        constant=np.triu(constant),
        mass=np.triu(mass),
        below=q - len(dual.joints) + sum(int((each.pivots < 0.0).sum()) for each in fixed),
    )


def _nothing() -> FloatArray:
    return np.zeros(0)


@dataclass(frozen=True, eq=False)
class _Body:
    """Wrenches at `rows` of S (k,), their B^T (N, n, k), M and K (N, n, n), and shapes (n, r) on the n coordinates.

    Of a body that does not follow the pose also X^T (n, n), d (n,), X^T M X (n,) and X^T M V (n, r).
    """

    rows: IntArray
    forces: FloatArray
    mass: FloatArray
    stiffness: FloatArray
    shapes: FloatArray
    root: FloatArray = field(default_factory=_nothing)
    pivots: FloatArray = field(default_factory=_nothing)
    inertias: FloatArray = field(default_factory=_nothing)
    load: FloatArray = field(default_factory=_nothing)

    @property
    def follows(self) -> bool:
        return len(self.mass) > 1


def _bodies(dual: DualSystems, shapes: FloatArray, place: IntArray, shift: float, at: float) -> Iterator[_Body]:
    start = 0
    for name, element in dual.elements.items():
        (some, held, along), (rows, reading) = dual.coordinates[name], dual.bodies[name]
        whole = shapes[start : (start := start + element.size)]
        own = whole[some] - along @ whole[held]
        order = np.argsort(place[rows])
        forces = reading[:, order[:, None], some].swapaxes(1, 2)
        body = _Body(place[rows][order], forces, element.mass, element.stiffness, own)
        if len(some) < element.size:
            both = (slice(None), some[:, None], some)
            body = replace(body, mass=body.mass[both], stiffness=body.stiffness[both])
        yield body if body.follows else _decoupled(body, shift, at)


def _decoupled(body: _Body, shift: float, at: float) -> _Body:
    """X diagonalises K_0 - s M, to the unit matrix, and M."""
    mass, stiffness = body.mass[0], body.stiffness[0]
    scale = 1.0 / np.sqrt(np.diag(stiffness - shift * mass))
    lower = np.linalg.inv(np.linalg.cholesky((stiffness - shift * mass) * np.outer(scale, scale))) * scale
    inertias, turn = np.linalg.eigh(lower @ mass @ lower.T)
    root = turn.T @ lower
    pivots = 1.0 - (at - shift) * inertias
    if np.any(np.abs(pivots) <= np.finfo(float).eps * (1.0 + (at - shift) * inertias)):
        raise np.linalg.LinAlgError("the shift is an eigenvalue of a body alone")
    return replace(body, root=root, pivots=pivots, inertias=inertias, load=root @ mass @ body.shapes)


def _flat(arrays: Sequence[FloatArray]) -> FloatArray:
    return np.concatenate([np.zeros(0), *(each.ravel() for each in arrays)])


def _side_by_side(stacks: Sequence[FloatArray], count: int) -> FloatArray:
    """Stacks (N, ..) or (1, ..) as one array (N, m)."""
    stops = np.cumsum([0, *(each[0].size for each in stacks)]).tolist()
    result = np.empty((count, stops[-1]))
    for each, start, stop in zip(stacks, stops[:-1], stops[1:], strict=True):
        result[:, start:stop].reshape(count, *each.shape[1:])[:] = each
    return result


def _elimination_of(dual: DualSystems) -> tuple[IntArray, _Indices, _Indices]:
    """Where in S each of its rows goes (q,), and the fill, see Packed; coordinates that only joints hold come last."""
    c, place = len(dual.joints), len(dual.joints)
    groups = [rows.tolist() for rows, _ in dual.compliances]
    for name, (rows, _) in dual.bodies.items():
        groups.append(rows.tolist())
        held = range(place, place := place + len(dual.coordinates[name].held))
        groups += [[coordinate, *rows.tolist()] for coordinate in held]
    order, fill = _elimination(tuple(map(tuple, groups)), c, dual.size)
    places = np.argsort(order).astype(np.int64)
    columns = [np.sort(places[list(each)]) for each in fill]
    starts = np.cumsum([0, *map(len, columns)], dtype=np.int64)
    return places, starts, np.concatenate([np.zeros(0, dtype=np.int64), *columns])


@lru_cache(maxsize=8)
def _elimination(groups: _Groups, first: int, size: int) -> tuple[tuple[int, ...], _Groups]:
    """Order of the rows of a matrix in which each group is full, and the columns that each meets when it is eliminated.

    Of the `first` rows, and then of the rest, next is always that whose elimination fills least (Tinney's scheme 3).
    """
    beside: list[set[int]] = [set() for _ in range(size)]
    for group in groups:
        for row in group:
            beside[row] |= set(group) - {row}
    order: list[int] = []
    fill: list[tuple[int, ...]] = []
    for left in (set(range(first)), set(range(first, size))):
        while left:
            row = min(left, key=lambda i: (sum(len(beside[i] - beside[j]) for j in beside[i]), i))
            for other in beside[row]:
                beside[other] = (beside[other] | beside[row]) - {row, other}
            left.remove(row)
            order.append(row)
            fill.append(tuple(beside[row]))
    return tuple(order), tuple(fill)
