"""What is known of a part is held against what was read of it."""

import pytest

import prs_model as prs
from tests.meshes import STEEL, box, write

MASS = 7850.0 * 0.35 * 0.05**2


@pytest.fixture
def rod(tmp_path):
    mesh = write(box((0.35, 0.05, 0.05), (5, 1, 1)), tmp_path / "rod.msh", scale=1000.0)

    def read(units="mm-N-tonne-s", **more):
        return prs.reduce("solid", mesh, interfaces={"hinge": {"set": "x0"}}, units=units, material=STEEL, **more)

    return read


def test_a_part_that_is_as_expected_passes(rod):
    rod(expected={"mass": MASS, "frequency": 2000.0, "tolerance": 0.2})


@pytest.mark.parametrize(
    ("more", "words"),
    [
        (
            {"expected": {"frequency": 1000.0}},
            r"expected.frequency: found \d+\S* Hz, expected 1000 Hz within 5 %; check 'units'",
        ),
        (
            {"expected": {"mass": MASS}, "units": "in-lbf-slinch-s"},
            r"expected.mass: found 112559 kg, expected 6\.86875 kg within 5 %",
        ),
        ({"expected": {"frequency": 9.0}, "modes": 0}, "expected.frequency: found none, expected 9 Hz"),
        ({"expected": {"mass": 1.0}, "clamped": ["x1"], "grounded": True}, "expected.mass: a part that is held"),
    ],
)
def test_another_part_is_refused_by_the_name_of_its_file(rod, more, words):
    with pytest.raises(prs.PartFileError, match=rf"rod\.msh: .*{words}"):
        rod(**more)


def test_a_mass_without_inertia_is_weighed(rod):
    """No frequencies are asked of what has none."""
    prs.reduce("rigid", mass=2.5, nodes={"a": (0.0, 0.0, 0.0)}, expected={"mass": 2.5})
    with pytest.raises(prs.PartFileError, match=r"rigid: expected\.mass: found 2\.5 kg, expected 8\.4 kg within 1 %"):
        prs.reduce("rigid", mass=2.5, nodes={"a": (0.0, 0.0, 0.0)}, expected={"mass": 8.4, "tolerance": 0.01})
