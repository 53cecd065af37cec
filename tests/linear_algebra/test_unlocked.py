"""LAPACK called past SciPy's wrappers, against the wrappers."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest
from scipy.linalg import LinAlgError, eigh

from prs_model.linear_algebra.unlocked import largest_of_pencil


def pencil(n: int, seed: int = 0) -> tuple[np.ndarray, np.ndarray]:
    """A symmetric matrix of half the rank, and a positive definite one."""
    rng = np.random.default_rng(seed)
    a, b = rng.normal(size=(n, (n + 1) // 2)), rng.normal(size=(n, n))
    return a @ a.T, b @ b.T + n * np.eye(n)


@pytest.mark.parametrize(("n", "count"), [(1, 1), (2, 1), (7, 3), (60, 12), (183, 15), (20, 20), (5, 9)])
def test_the_largest_eigenvalues_are_those_of_scipy(n: int, count: int) -> None:
    a, b = pencil(n)
    copies = a.copy(), b.copy()
    values, vectors = largest_of_pencil(a, b, count)
    expected = eigh(a, b, eigvals_only=True)[::-1][:count]
    np.testing.assert_allclose(values, expected, atol=1e-13 * expected[0])
    np.testing.assert_allclose(vectors.T @ b @ vectors, np.eye(len(expected)), atol=1e-12)
    assert np.abs(a @ vectors - b @ vectors * values).max() < 1e-11 * np.abs(a).max()
    assert all(np.array_equal(was, now) for was, now in zip(copies, (a, b), strict=True))


def test_repeated_eigenvalues_have_vectors_of_their_own() -> None:
    _, b = pencil(12)
    values, vectors = largest_of_pencil(3.0 * b, b, 5)
    np.testing.assert_allclose(values, 3.0)
    np.testing.assert_allclose(vectors.T @ b @ vectors, np.eye(5), atol=1e-12)


def test_an_indefinite_matrix_is_told() -> None:
    a, b = pencil(9)
    with pytest.raises(LinAlgError, match="dsygvx"):
        largest_of_pencil(a, b - 2.0 * np.linalg.eigvalsh(b)[-1] * np.eye(9), 3)


def test_threads_do_not_disturb_each_other() -> None:
    """Each has matrices of its own, and finds what it finds alone."""
    pencils = [pencil(50, seed) for seed in range(12)]
    alone = [largest_of_pencil(a, b, 6) for a, b in pencils]
    with ThreadPoolExecutor(4) as pool:
        together = list(pool.map(lambda pair: largest_of_pencil(*pair, 6), pencils))
    for one, other in zip(alone, together, strict=True):
        assert np.array_equal(one[0], other[0])
        assert np.array_equal(one[1], other[1])
