"""What others have found of a machine, beside what the model finds."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

from ..modes.clusters import EQUAL, clusters
from ..response.quantity import DIRECTIONS

if TYPE_CHECKING:
    from ..description.schema import Verification
    from .study import Study


@dataclass(frozen=True)
class Share:
    """Of the static compliance along a direction, by a mode and those of equal frequency: published and the model's.

    largest: the model's own largest, by the modes that give it.
    """

    source: str
    direction: str
    mode: int
    published: float
    model: float
    largest: str


def published_shares(study: Study, verification: Verification | None) -> tuple[Share, ...]:
    """Of the modes that the study has; none unless it is at the reference pose, which they are published for."""
    return tuple(_shares(study, verification)) if verification is not None and study.is_reference else ()


def _shares(study: Study, verification: Verification) -> Iterator[Share]:
    if study.at_rest is None:
        return
    numbers = clusters(study.modes.frequencies, EQUAL)
    for source, by_direction in verification.shares.items():
        for direction, known in by_direction.items():
            if known.mode > len(numbers):
                continue
            ours = study.at_rest.shares[:, DIRECTIONS.index(direction)]
            sums = {int(number): float(ours[numbers == number].sum()) for number in numbers}
            most = max(sums, key=lambda number: sums[number])
            who = " and ".join(str(k + 1) for k in range(len(numbers)) if numbers[k] == most)
            same = sums[int(numbers[known.mode - 1])]
            yield Share(source, direction, known.mode, known.share, same, f"{100.0 * sums[most]:.1f} % by {who}")
