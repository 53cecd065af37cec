"""Rigid wrenches that hold what others hold already: the dual form of a machine is singular with them."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from ..arrays import BoolArray, FloatArray, IntArray
from .dual import DualSystems

_DEPENDENT = 1e-9  # of a row, what is left of it beside the others


def without_redundant(dual: DualSystems) -> DualSystems:
    """The same without rigid wrenches that depend on those before them in every configuration; all of them, where
    some depend in some configurations only."""
    rigid = _rigid(dual)
    first = _readings(dual, rigid, slice(0, 1))[0]
    independent = _independent(first)
    if independent.all() or not _depend(_readings(dual, rigid, slice(None)), independent):
        return dual
    kept = np.ones(len(dual.joints), dtype=bool)
    kept[rigid[~independent]] = False
    number = np.cumsum(kept) - 1
    return replace(
        dual,
        joints=tuple(joint for joint, keep in zip(dual.joints, kept, strict=True) if keep),
        compliances=tuple(
            (number[rows[kept[rows]]], compliance[:, kept[rows]][:, :, kept[rows]])
            for rows, compliance in dual.compliances
        ),
        bodies={
            name: (number[rows[kept[rows]]], reading[:, kept[rows]]) for name, (rows, reading) in dual.bodies.items()
        },
    )


def _rigid(dual: DualSystems) -> IntArray:
    """Wrenches whose joints have no compliance along them in any configuration."""
    rigid = [rows[~np.any(compliance, axis=(0, 1))] for rows, compliance in dual.compliances]
    return np.concatenate([np.zeros(0, dtype=np.int64), *rigid])


def _readings(dual: DualSystems, rigid: IntArray, some: slice) -> FloatArray:
    """Of the rigid wrenches B (N, r, n) on all bodies, in some of the configurations, to unit rows."""
    place = np.full(len(dual.joints), -1)
    place[rigid] = np.arange(len(rigid))
    parts = []
    for rows, reading in dual.bodies.values():
        mine = np.flatnonzero(place[rows] >= 0)
        own = reading[some if len(reading) > 1 else slice(None)]
        part = np.zeros((len(own), len(rigid), own.shape[2]))
        part[:, place[rows[mine]]] = own[:, mine]
        parts.append(part)
    many = max(len(each) for each in parts)
    whole = np.concatenate([np.broadcast_to(each, (many, *each.shape[1:])) for each in parts], axis=2)
    sizes = np.linalg.norm(whole, axis=2, keepdims=True)
    return np.asarray(whole / np.maximum(sizes, _DEPENDENT * sizes.max(initial=0.0) or 1.0))


def _independent(rows: FloatArray) -> BoolArray:
    """Which of the rows (r, n) do not depend on those before them."""
    basis = np.zeros((0, rows.shape[1]))
    found = np.zeros(len(rows), dtype=bool)
    for i, row in enumerate(rows):
        for _ in range(2):  # a second time for what rounding left
            row = row - basis.T @ (basis @ row)
        size = np.linalg.norm(row)
        if size > _DEPENDENT:
            found[i] = True
            basis = np.concatenate([basis, row[None] / size])
    return found


def _depend(rows: FloatArray, independent: BoolArray) -> bool:
    """Whether the others do on those in every configuration (N, r, n)."""
    kept, others = rows[:, independent], rows[:, ~independent]
    try:
        factors = np.linalg.solve(kept @ kept.swapaxes(1, 2), kept @ others.swapaxes(1, 2))
    except np.linalg.LinAlgError:
        return False
    return bool(np.abs(others - factors.swapaxes(1, 2) @ kept).max() < _DEPENDENT)
