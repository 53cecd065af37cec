"""The kernels in NumPy and those of numba agree."""

from __future__ import annotations

import ast
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from prs_model.sweep import kernels

SIZES = [(1, 1), (1, 40), (2, 31), (6, 33), (9, 100), (14, 64)]


@pytest.fixture(scope="module")
def compiled() -> ModuleType:
    pytest.importorskip("numba", reason="compiled kernels come with the extra `fast`")
    from prs_model.sweep import kernels_jit

    return kernels_jit


def packed(matrices: np.ndarray) -> np.ndarray:
    rows, columns = np.tril_indices(matrices.shape[1])
    return np.ascontiguousarray(matrices[:, rows, columns].T)


def with_eigenvalues(values: np.ndarray) -> np.ndarray:
    """Symmetric matrices (m, p, p) with eigenvalues (m, p), turned at random."""
    m, p = values.shape
    turns = np.linalg.qr(np.random.default_rng(8).normal(size=(m, p, p)))[0]
    return (turns * values[:, None]) @ turns.swapaxes(1, 2)


def spectra(p: int, m: int) -> np.ndarray:
    """Eigenvalues (m, p): any, repeated, zero, of very different sizes, by turns."""
    rng = np.random.default_rng(9)
    values = rng.normal(size=(m, p))
    values[1::4] = np.round(values[1::4])
    values[2::4, : p // 2] = 0.0
    values[3::4] *= 10.0 ** rng.uniform(-8.0, 4.0, size=values[3::4].shape)
    return values


@pytest.mark.parametrize(("p", "m"), SIZES)
def test_eigenvalues_are_those_the_matrices_were_made_of(compiled: ModuleType, p: int, m: int) -> None:
    values = spectra(p, m)
    found = compiled.eigenvalues(packed(with_eigenvalues(values)), p)
    assert found.shape == (p, m)
    assert (np.diff(found, axis=0) >= 0.0).all()
    size = np.abs(values).max(axis=1)
    assert (np.abs(found.T - np.sort(values, axis=1)).max(axis=1) <= 1e-13 * p * size).all()
    twin = kernels.eigenvalues(packed(with_eigenvalues(values)), p)
    assert (np.abs(found - twin).max(axis=0) <= 1e-13 * p * size).all()


def test_diagonal_and_zero_matrices_come_out_exactly(compiled: ModuleType) -> None:
    diagonals = np.array([[3.0, -1.0, 3.0, 0.0], [0.0, 0.0, 0.0, 0.0]])
    matrices = packed(diagonals[:, None] * np.eye(4))
    for module in (kernels, compiled):
        assert module.eigenvalues(matrices, 4).T.tolist() == np.sort(diagonals).tolist()


@pytest.mark.parametrize(("p", "m"), SIZES)
def test_negatives_are_those_below_the_slack(compiled: ModuleType, p: int, m: int) -> None:
    rng = np.random.default_rng(10)
    values = rng.uniform(0.1, 2.0, size=(m, p)) * rng.choice([-1, 1], (m, p))
    values[::3, 0] = np.resize([0.0, 5e-3, -5e-3], len(values[::3]))
    matrices = packed(with_eigenvalues(values))
    for module in (kernels, compiled):
        np.testing.assert_array_equal(module.negatives(matrices, p, 1e-2), (values < -1e-2).sum(axis=1))
        np.testing.assert_array_equal(module.negatives(matrices, p, 1e-3), (values < -1e-3).sum(axis=1))


def test_where_no_row_is_left_none_is_negative(compiled: ModuleType) -> None:
    for module in (kernels, compiled):
        assert module.negatives(np.empty((0, 5)), 0, 1e-3).tolist() == [0] * 5


def test_a_pivot_that_vanishes_is_no_obstacle(compiled: ModuleType) -> None:
    """[[0, 1], [1, 0]] has one negative eigenvalue; elimination in order meets a zero, and may say it doubts."""
    matrix = np.array([[0.0], [1.0], [0.0]])
    assert kernels.negatives(matrix, 2, 0.0).tolist() == [1]
    assert compiled.negatives(matrix, 2, 0.0)[0] in (1, -1)


def test_matrices_are_packed_by_rows_of_the_lower_triangle() -> None:
    matrices = with_eigenvalues(spectra(5, 7))
    np.testing.assert_allclose(kernels.unpacked(packed(matrices), 5), matrices, atol=1e-15)


@pytest.mark.parametrize("name", ["kernels", "kernels_jit"])
def test_kernels_import_numpy_and_numba_only(name: str) -> None:
    """They can be lifted out of the project as they are."""
    tree = ast.parse((Path(kernels.__file__).parent / f"{name}.py").read_text())
    imports = {
        alias.name if isinstance(node, ast.Import) else "." * node.level + str(node.module)
        for node in ast.walk(tree)
        if isinstance(node, ast.Import | ast.ImportFrom)
        for alias in node.names
    }
    assert imports <= {"__future__", "numba", "numpy", "numpy.typing"}
