"""Finite-element models of single parts: sparse matrices, nodes, named node sets."""

from .mass import MassProperties
from .model import FiniteElementModel

__all__ = ["FiniteElementModel", "MassProperties"]
