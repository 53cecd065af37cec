"""Our own reducers keep what the kit asks of every reducer. Damage has its own tables, in test_damage."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

import prs_model as prs
from prs_model.testing import Sample, conformance
from tests.reducers.samples import OWN, WITHOUT_FILE, ansys_full, subdyn
from tests.superelements import needs_data

Make = Callable[[Path], Sample]


def keeps_every_promise(make: Make, folder: Path) -> None:
    try:
        sample = make(folder)
        checks = [check for check in conformance(sample) if str(check) != "damage_is_noticed"]
        for check in checks:
            check()
    except prs.MissingExtraError as error:
        pytest.skip(str(error))


@pytest.mark.parametrize("make", [*OWN, *WITHOUT_FILE], ids=lambda make: make.__name__)
def test_conformance(make: Make, tmp_path: Path) -> None:
    keeps_every_promise(make, tmp_path)


@needs_data
@pytest.mark.parametrize("make", [ansys_full, subdyn], ids=lambda make: make.__name__)
def test_conformance_of_real_exports(make: Make, tmp_path: Path) -> None:
    keeps_every_promise(make, tmp_path)


def test_every_reducer_has_a_sample(tmp_path: Path) -> None:
    named = set()
    for make in (*OWN, *WITHOUT_FILE):
        folder = tmp_path / make.__name__
        folder.mkdir()
        named.add(make(folder).reducer)
    ours = {name for name in prs.list_reducers() if prs.plugins.reducer(name).__module__.startswith("prs_reducers.")}
    assert ours == named
