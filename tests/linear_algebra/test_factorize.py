"""Direct solution: SuperLU, and PARDISO where it can be used."""

import gc
import sys
from types import ModuleType

import numpy as np
import pytest
from scipy.sparse import csr_array, diags_array

from prs_model.linear_algebra import factorize

MATRIX = csr_array(diags_array([-1.0, 2.5, -1.0], offsets=(-1, 0, 1), shape=(30, 30)))


@pytest.mark.parametrize("module", [None, ModuleType("pypardiso")])
def test_without_a_sound_pardiso_it_is_superlu(module, monkeypatch):
    monkeypatch.setitem(sys.modules, "pypardiso", module)
    b = np.arange(60.0).reshape(30, 2)
    assert MATRIX @ factorize(MATRIX)(b) == pytest.approx(b)
    with pytest.raises(np.linalg.LinAlgError):
        factorize(csr_array((3, 3)))


def test_the_memory_of_pardiso_is_freed(monkeypatch):
    freed = []

    class Solver:
        def __init__(self, mtype: int) -> None: ...

        def factorize(self, upper: csr_array) -> None: ...

        def solve(self, upper: csr_array, b: np.ndarray) -> np.ndarray:
            return b / 2.0

        def free_memory(self, everything: bool) -> None:
            freed.append(everything)

    package, wrapper = ModuleType("pypardiso"), ModuleType("pypardiso.pardiso_wrapper")
    package.PyPardisoSolver, wrapper.PyPardisoError = Solver, RuntimeError
    monkeypatch.setitem(sys.modules, "pypardiso", package)
    monkeypatch.setitem(sys.modules, "pypardiso.pardiso_wrapper", wrapper)
    solve = factorize(MATRIX)
    assert solve(np.ones(30)) == pytest.approx(np.full(30, 0.5))
    assert not freed
    del solve
    gc.collect()
    assert freed == [True]
