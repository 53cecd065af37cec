"""Writes bar.lab: a steel bar of 300 x 30 x 20 mm, held at its ends, from the formulas of the slender beam."""

from pathlib import Path

import numpy as np

LENGTH, WIDTH, HEIGHT = 300.0, 30.0, 20.0  # along x, y, z
E, NU, DENSITY = 2.1e5, 0.3, 7.85e-9
AREA, IY, IZ = WIDTH * HEIGHT, WIDTH * HEIGHT**3 / 12, HEIGHT * WIDTH**3 / 12
TORSION = 0.1957 * WIDTH * HEIGHT**3  # of a rectangle 3 : 2
CLAMPED = 4.730040744862704  # the first root of cos x cosh x = 1
MASS = DENSITY * AREA * LENGTH
FREQUENCIES = [CLAMPED**2 / LENGTH**2 * np.sqrt(E * i / (DENSITY * AREA)) / (2 * np.pi) for i in (IY, IZ)]


def matrices() -> tuple[np.ndarray, np.ndarray]:
    """Of both ends' six motions, then one bending mode in z and one in y: (14, 14) each."""
    stiffness, mass = np.zeros((14, 14)), np.zeros((14, 14))
    pair = np.array([[1.0, -1.0], [-1.0, 1.0]])
    for rows, k, m in (([0, 6], E * AREA, DENSITY * AREA), ([3, 9], E / (2 + 2 * NU) * TORSION, DENSITY * (IY + IZ))):
        stiffness[np.ix_(rows, rows)] += k / LENGTH * pair
        mass[np.ix_(rows, rows)] += m * LENGTH / 6 * (pair * pair + np.eye(2))
    x, weights = np.polynomial.legendre.leggauss(40)
    x, weights = (x + 1) / 2, weights / 2 * MASS
    hermite = np.array([1 - 3 * x**2 + 2 * x**3, x - 2 * x**2 + x**3, 3 * x**2 - 2 * x**3, x**3 - x**2])
    bent = np.array([12 * x - 6, 6 * x - 4, 6 - 12 * x, 6 * x - 2])
    s = (np.cosh(CLAMPED) - np.cos(CLAMPED)) / (np.sinh(CLAMPED) - np.sin(CLAMPED))
    shape = np.cosh(CLAMPED * x) - np.cos(CLAMPED * x) - s * (np.sinh(CLAMPED * x) - np.sin(CLAMPED * x))
    shape /= np.sqrt(weights @ shape**2)
    for mode, (rows, turn, inertia, hz) in enumerate(
        (([2, 4, 8, 10], -1.0, IY, FREQUENCIES[0]), ([1, 5, 7, 11], 1.0, IZ, FREQUENCIES[1])), start=12
    ):
        scale = np.array([1.0, turn * LENGTH, 1.0, turn * LENGTH])
        curved, moved = scale[:, None] * bent, scale[:, None] * hermite
        stiffness[np.ix_(rows, rows)] += E * inertia / LENGTH**3 * (curved * weights / MASS) @ curved.T
        mass[np.ix_(rows, rows)] += (moved * weights) @ moved.T
        mass[rows, mode] = mass[mode, rows] = (moved * weights) @ shape
        stiffness[mode, mode], mass[mode, mode] = (2 * np.pi * hz) ** 2, 1.0
    return stiffness, mass


def write(path: Path) -> None:
    """Write the bar as the laboratory does."""
    lines = ["# steel bar 300 x 30 x 20, held at its ends; mm, N, tonne, s", "points 2"]
    lines += ["left 0 0 0", f"right {LENGTH:g} 0 0", "modes 2"]
    lines += [f"{name} {hz:.4f}" for name, hz in zip(("flapwise", "edgewise"), FREQUENCIES, strict=True)]
    for name, matrix in zip(("stiffness", "mass"), matrices(), strict=True):
        matrix = (matrix + matrix.T) / 2
        lines += [f"{name} {len(matrix)}", *(" ".join(f"{entry:.16e}" for entry in row) for row in matrix)]
    path.write_text("\n".join([*lines, "end", ""]))


if __name__ == "__main__":
    write(Path(__file__).parent / "bar.lab")
