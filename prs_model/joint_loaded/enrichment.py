"""Shapes besides the static ones, chosen by what the machine's own modes need most.

Of the machine's modes at sampled poses, each with one unit of strain energy, the static shapes of a part and its
springs leave some energy out. Directions in the part's candidate shapes are ranked by how much of it they bring in,
which is about the relative error of the squared frequencies: a proper orthogonal decomposition of what is missing.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..arrays import FloatArray
from .held import Held

REPEATED = 1e-9  # of the largest overlap: candidates that static shapes or others make up
MOST_PATTERNS = 6  # ways in which the body beyond a travelling contact deforms


@dataclass(frozen=True, eq=False)
class Directions:
    """Combinations (c, k) of a part's candidate shapes and the energy (k,) that each brings in, the largest first."""

    combinations: FloatArray
    energies: FloatArray


@dataclass(frozen=True, eq=False)
class Sight:
    """A held part with the shapes (n, s) that the machine's modes give it, and its static and candidate shapes."""

    part: Held
    shapes: FloatArray
    static: FloatArray
    candidates: FloatArray


def directions(sights: Sequence[Sight]) -> Directions:
    """The best directions for all sights of a part together, whose candidates correspond."""
    overlap, captured = (np.asarray(sum(each)) for each in zip(*(_missing(sight) for sight in sights), strict=True))
    weight, combination = np.linalg.eigh(overlap)
    apart = weight > REPEATED * weight.max(initial=0.0)
    whitened = combination[:, apart] / np.sqrt(weight[apart] / len(sights))
    energy, rotation = np.linalg.eigh(whitened.T @ captured @ whitened)
    return Directions(whitened @ rotation[:, ::-1], np.maximum(energy[::-1], 0.0))


def _missing(sight: Sight) -> tuple[FloatArray, FloatArray]:
    """Z^T K Z and Z^T K X X^T K Z of the machine's shapes X and the candidates Z less what static shapes make up."""
    stiffness, static = sight.part.stiffness, sight.static
    force = stiffness @ static
    share = np.linalg.lstsq(static.T @ force, force.T @ sight.candidates, rcond=1e-12)[0]
    candidates = sight.candidates - static @ share
    work = candidates.T @ stiffness @ sight.shapes
    overlap = candidates.T @ stiffness @ candidates
    return (overlap + overlap.T) / 2.0, work @ work.T


def counts(ranked: Mapping[tuple[str, ...], Directions], total: int) -> dict[tuple[str, ...], int]:
    """How many directions each kind of part, named by its bodies, takes of `total` coordinates of all bodies.

    Those that bring in most energy per coordinate come first.
    """
    taken = dict.fromkeys(ranked, 0)
    gains = [
        (float(energy) / len(kind), kind, place)
        for kind, found in ranked.items()
        for place, energy in enumerate(found.energies)
        if energy > 0.0
    ]
    for _, kind, place in sorted(gains, key=lambda gain: -gain[0]):
        if place == taken[kind] and len(kind) <= total:
            taken[kind] += 1
            total -= len(kind)
    return taken


def patterns_beyond(sights: Sequence[tuple[Held, Mapping[str, FloatArray]]]) -> dict[int, FloatArray]:
    """Of each grip (by its place) with several springs: how the body beyond deforms between them, (m, k), most first.

    sights: a part as held in each sample, and the machine's shapes of all bodies there. What is left of the far ends'
    motions after the rigid motion that fits them best, in the energy of the springs.
    """
    found = {}
    for place, grip in enumerate(sights[0][0].grips):
        if grip.several and grip.body is not None:
            left = [_deformation(part, place, shapes) for part, shapes in sights]
            basis = np.linalg.svd(np.hstack(left), full_matrices=False)[0][:, :MOST_PATTERNS]
            found[place] = _root(grip.compliance) @ basis
    return found


def _deformation(part: Held, place: int, shapes: Mapping[str, FloatArray]) -> FloatArray:
    grip = part.grips[place]
    weight = np.linalg.inv(_root(grip.compliance))
    moved, rigid = weight @ grip.other @ shapes[str(grip.body)], weight @ grip.beyond
    return np.asarray(moved - rigid @ np.linalg.lstsq(rigid, moved, rcond=None)[0])


def _root(compliance: FloatArray) -> FloatArray:
    values, vectors = np.linalg.eigh(compliance)
    return np.asarray((vectors * np.sqrt(values)) @ vectors.T)
