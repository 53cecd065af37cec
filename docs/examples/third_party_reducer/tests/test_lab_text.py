"""The kit's checks on a bar whose mass and frequencies are known from formulas."""

from collections.abc import Callable
from math import pi, sqrt
from pathlib import Path

import pytest

from prs_model.testing import Sample, conformance

LENGTH, WIDTH, HEIGHT, E, DENSITY = 0.3, 0.03, 0.02, 2.1e11, 7850.0  # m, N/m^2, kg/m^3
RADII = [side / sqrt(12) for side in (HEIGHT, WIDTH)]

BAR = Sample(
    "lab_text",
    Path(__file__).parent / "bar.lab",
    units="mm-N-tonne-s",
    interfaces={"base": {"node": "left"}, "tip": {"node": "right"}},
    mass=DENSITY * LENGTH * WIDTH * HEIGHT,
    fixed=tuple(4.730040745**2 * sqrt(E / DENSITY) * radius / LENGTH**2 / (2 * pi) for radius in RADII),
)


@pytest.mark.parametrize("check", conformance(BAR), ids=str)
def test_conformance(check: Callable[[], None]) -> None:
    check()
