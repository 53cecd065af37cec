"""Which known name a wrong one most likely means."""

import pytest

from prs_model.description.problems import closest


@pytest.mark.parametrize(
    ("found", "known", "meant"),
    [
        ("nif1", ["NALL", "NIF1", "NIF2"], "NIF1"),
        ("Block-1.Set-1", ["All", "SET-1"], "SET-1"),
        ("head", ["hexapod", "head_3prs_long", "head_3prs"], "head_3prs"),
        ("ar", ["axle_right"], None),
        ("spindle", ["table", "bed"], None),
    ],
)
def test_the_name_that_was_meant(found: str, known: list[str], meant: str | None) -> None:
    assert closest(found, known) == meant
