"""OpenFAST's ExtPtfm files of a small substructure, in the layouts of the user's guide."""

from __future__ import annotations

import numpy as np


def matrix(values: np.ndarray) -> list[str]:
    return [" ".join(f"{value:.8e}" for value in row) for row in values]


K = np.diag([2e8, 2e8, 1e9, 3e10, 3e10, 1e10, (2.0 * np.pi * 3.0) ** 2])
M = np.diag([1e5, 1e5, 1e5, 2e6, 2e6, 1e6, 1.0])
M[0, 6] = M[6, 0] = 50.0


def flex() -> str:
    """A clamped substructure with one mode, in the layout of the user's guide."""
    lines = ["!Made up", "!Flex 5 Format", "!Dimension: 7", "!Time increment in simulation: 0.1"]
    lines += ["!Total simulation time in file: 0.2", ""]
    for name, values in (("Mass", M), ("Stiffness", K), ("Damping", 0.0 * K)):
        lines += [f"!{name} Matrix", "!Dimension: 7", *matrix(values), ""]
    lines += ["!Loading and Wave Elevation", "!Dimension: 1 time column - 7 force columns"]
    return "\n".join([*lines, *matrix(np.column_stack([[0.0, 0.1, 0.2], np.zeros((3, 7))]))]) + "\n"


def guyan() -> str:
    blocks = [f"{line}" for values in (M[:6, :6], 0 * K[:6, :6], K[:6, :6]) for line in ("#", *matrix(values[:6, :6]))]
    blocks[0], blocks[7], blocks[14] = "#Mass", "#Damping", "#Stiffness"
    return "\n".join(["Made up", *blocks, "# loads", "# Time Fx Fy Fz Mx My Mz", "# s N"]) + "\n"
