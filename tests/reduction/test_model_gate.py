"""The gate of full matrices: what a reduction would hide."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array

import prs_model as prs
from prs_model.finite_elements import FiniteElementModel
from prs_model.reduction.model_gate import check_model
from tests.meshes import box, steel


@pytest.fixture(scope="module")
def model() -> FiniteElementModel:
    return steel(box((0.4, 0.1, 0.08), (3, 1, 1)))


def scaled(matrix: csr_array, rows: np.ndarray, factor: float) -> csr_array:
    scale = np.ones(matrix.shape[0])
    scale[rows] = factor
    return csr_array(diags_array(scale) @ matrix @ diags_array(scale))


def test_a_sound_model_passes(model):
    names = [check.name for check in check_model(model, grounded=False).checks]
    assert "three equal translational masses" in names
    assert "three equal translational masses" not in [c.name for c in check_model(model, grounded=True).checks]


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda m: {"stiffness": scaled(m.stiffness, m.rows[3], 1.01)}, "rigid motion is free"),
        (lambda m: {"coordinates": m.coordinates * [1.0, 1.0, 1.001]}, "rigid motion is free"),
        (lambda m: {"mass": scaled(m.mass, m.rows[:, 2], 1.01)}, "three equal translational masses"),
        (lambda m: {"mass": csr_array(0.0 * m.mass)}, "the part has no mass: .*give the material a density, or name"),
        (lambda m: {"mass": csr_array(-m.mass)}, "negative diagonal entries of the mass"),
        (lambda m: {"stiffness": csr_array(np.tril(m.stiffness.toarray()))}, "stiffness is symmetric"),
    ],
)
def test_what_is_no_free_part_is_named(model, change, words):
    with pytest.raises(prs.PhysicsError, match=words):
        check_model(replace(model, **change(model)), grounded=False)


def test_a_part_held_in_its_file_cannot_be_clamped_too(model):
    """'grounded: true' was said already: the advice is another one."""
    held = model.clamp(["x0"])
    with pytest.raises(prs.PhysicsError, match=r"say 'grounded: true'"):
        check_model(held, grounded=False)
    check_model(held, grounded=True)
    with pytest.raises(prs.PhysicsError, match="it cannot be clamped here too: leave 'clamped' out"):
        check_model(held, grounded=True, clamped=True)
