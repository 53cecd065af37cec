"""Eigenproblems and factorizations, on matrices that may be singular or large."""

from .eigen import lowest_modes, positive_definite_pencil, slowest, slowest_rate
from .factorize import Solve, factorize
from .sparse_eigen import lowest_eigenvalues

__all__ = [
    "Solve",
    "factorize",
    "lowest_eigenvalues",
    "lowest_modes",
    "positive_definite_pencil",
    "slowest",
    "slowest_rate",
]
