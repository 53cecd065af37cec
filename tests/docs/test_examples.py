"""Every example of the documentation runs and prints its table."""

import runpy
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs

EXAMPLES = sorted((Path(__file__).parents[2] / "docs" / "examples").glob("*.py"))


@pytest.mark.parametrize("example", EXAMPLES, ids=[path.stem for path in EXAMPLES])
def test_example_runs(example: Path, capsys: pytest.CaptureFixture[str]) -> None:
    runpy.run_path(str(example), run_name="__main__")
    assert "Hz" in capsys.readouterr().out


def test_the_small_machine_of_the_documentation() -> None:
    """Three like limbs at 120 degrees: in-plane and out-of-plane pairs."""
    machine = prs.load_machine(EXAMPLES[0].parent / "planar_3rpr")
    frequencies = machine.modes(6).frequencies
    np.testing.assert_allclose(frequencies[[1, 3]], frequencies[[2, 4]], rtol=1e-6)
