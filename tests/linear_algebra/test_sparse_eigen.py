"""Lowest eigenvalues of sparse pencils: small ones solved densely, large ones by Lanczos, with the same answers."""

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array

from prs_model.errors import PrsError
from prs_model.linear_algebra import lowest_eigenvalues
from prs_model.linear_algebra.sparse_eigen import DENSE

SIZES = pytest.mark.parametrize("n", [40, DENSE + 100])


def chain(n: int, held: bool) -> csr_array:
    """Springs of one between n masses, the first on the ground where it is held."""
    diagonal = np.full(n, 2.0)
    diagonal[-1], diagonal[0] = 1.0, 2.0 if held else 1.0
    return csr_array(diags_array([-np.ones(n - 1), diagonal, -np.ones(n - 1)], offsets=(-1, 0, 1)))


@SIZES
def test_a_free_chain_has_zero_among_its_eigenvalues(n):
    """4 sin^2(k pi / 2 n), k = 0, 1, 2 .."""
    found = lowest_eigenvalues(chain(n, held=False), csr_array(diags_array(np.ones(n))), 4)
    expected = 4.0 * np.sin(np.arange(4) * np.pi / (2 * n)) ** 2
    assert found == pytest.approx(expected, rel=1e-7, abs=1e-13)


@SIZES
def test_a_held_chain_has_none(n):
    found = lowest_eigenvalues(chain(n, held=True), csr_array(diags_array(np.ones(n))), 3)
    assert found == pytest.approx(4.0 * np.sin((2 * np.arange(3) + 1) * np.pi / (4 * n + 2)) ** 2, rel=1e-7)


@SIZES
def test_massless_rows_count_by_their_stiffness_only(n):
    """Every other mass left out: springs of one half between those that stay."""
    masses = np.arange(n) % 2 * 1.0
    found = lowest_eigenvalues(chain(n, held=True), csr_array(diags_array(masses)), 2)
    m = n // 2
    stiffness = 0.5 * chain(m, held=True).toarray()
    assert found == pytest.approx(np.linalg.eigvalsh(stiffness)[:2], rel=1e-7)


@SIZES
def test_what_has_no_frequencies_says_so(n):
    with pytest.raises(PrsError, match="no frequencies: the part has no mass, or no stiffness"):
        lowest_eigenvalues(chain(n, held=True), csr_array((n, n)), 2)
    idle = csr_array(diags_array((np.arange(n) != 5) * 1.0))
    with pytest.raises(PrsError, match="neither stiffness nor mass"):
        lowest_eigenvalues(idle, idle, 2)
