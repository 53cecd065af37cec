"""Damaged part files, every format: none crashes, hangs, fills the memory or becomes another part silently.

``pytest -s`` prints the tables. `unseen` in them is what no reader can tell: each sample names which damage that may
be, and why. With ``-m benchmark`` many more places are damaged.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from pathlib import Path

import pytest

import prs_model as prs
from prs_model.testing import Outcome, Sample, as_text, damage_table
from tests.reducers.samples import BIG, OWN, REAL
from tests.superelements import needs_data

Make = Callable[[Path], Sample]

# damage that may leave a sound file of another part
PLAUSIBLE = ("another digit", "a bit flipped", "a line missing", "neighbour lines swapped", "lines swapped", "units")


def examined(make: Make, folder: Path, places: int) -> tuple[Outcome, ...]:
    """The table of a sample, printed, without a fault in it."""
    try:
        sample = make(folder)
        sample.read()
    except prs.MissingExtraError as error:
        pytest.skip(str(error))
    table = damage_table(sample, places=places)
    print(f"\n{make.__name__}: {dict(Counter(each.result for each in table))}\n{as_text(table)}")
    faults = [each for each in table if each.is_fault]
    assert not faults, "\n" + as_text(faults)
    assert min(Counter(each.file for each in table).values()) >= 14
    assert all(each.damage.startswith(PLAUSIBLE) for each in table if each.result == "unseen")
    return table


@pytest.mark.parametrize("make", OWN, ids=lambda make: make.__name__)
def test_damage(make: Make, tmp_path: Path) -> None:
    examined(make, tmp_path, places=1)


@needs_data
@pytest.mark.parametrize("make", REAL, ids=lambda make: make.__name__)
def test_damage_of_real_exports(make: Make, tmp_path: Path) -> None:
    examined(make, tmp_path, places=1)


@pytest.mark.benchmark
@needs_data
@pytest.mark.parametrize("make", [*OWN, *REAL, *BIG], ids=lambda make: make.__name__)
def test_damage_at_many_places(make: Make, tmp_path: Path) -> None:
    examined(make, tmp_path, places=12)
