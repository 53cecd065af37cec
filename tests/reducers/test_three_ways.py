"""One bar as solid, as beams and as lumped masses: first free frequencies side by side (run with -s for the table).

A steel bar of 350 x 50 x 40 mm is stocky enough for the methods to differ, and each difference has a name:

- beam and solid: plane sections with Cowper's shear are a good theory here, 0.3 % in the first five modes. Along the
  axis the solid also moves sideways (Poisson), which beams do not: Love's factor 1 / sqrt(1 + nu^2 k^2 r^2), -0.12 %.
- lumped and beam: the springs are exact, the masses coarse. A chain of n pieces has sin(x)/x of the frequency along and
  about its axis, x = pi/2n, and comes from below as 1/n^2 in bending too, where the mesh of a solid comes from above.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

import prs_model as prs
from prs_model.finite_elements import FiniteElementModel
from prs_model.reduction import SuperElement
from prs_model.reduction.summary import summarize
from tests.meshes import STEEL, box, write

LENGTH, Y, Z = 0.35, 0.05, 0.04
E, NU, DENSITY = STEEL["E"], STEEL["nu"], STEEL["density"]
G, KAPPA = E / 2.6, 10.0 * (1.0 + NU) / (12.0 + 11.0 * NU)
AREA, ABOUT_Y, ABOUT_Z = Y * Z, Y * Z**3 / 12.0, Y**3 * Z / 12.0
TORSION = 0.17173 * Y * Z**3  # Saint-Venant's series at 1.25 to 1
POLAR = (Y**2 + Z**2) / 12.0  # squared radius of gyration
MODES = ("bending, soft", "bending, stiff", "torsion", "bending, soft", "bending, stiff")
MESH, PIECES = (28, 4, 3), (4, 8, 16)


def solid(folder: Path) -> np.ndarray:
    mesh = write(box((LENGTH, Y, Z), MESH), folder / "bar.msh")
    return elastic(prs.read_part("solid", mesh, units="m-N-kg-s", material=STEEL))


def beam() -> np.ndarray:
    section = {"kind": "rectangle", "y": Y, "z": Z, "material": STEEL}
    nodes = {"left": (0, 0, 0), "right": (LENGTH, 0, 0)}
    members = [{"between": ("left", "right"), "section": "bar", "elements": 40}]
    return elastic(prs.read_part("beam", nodes=nodes, sections={"bar": section}, members=members))


def lumped(pieces: int) -> np.ndarray:
    """Slices of the bar where its pieces meet, half ones at its ends; springs at the middle of each piece."""
    h = LENGTH / pieces
    stiffness = {
        "ux": E * AREA / h,
        "uy": 1.0 / (h**3 / (12.0 * E * ABOUT_Z) + h / (KAPPA * G * AREA)),
        "uz": 1.0 / (h**3 / (12.0 * E * ABOUT_Y) + h / (KAPPA * G * AREA)),
        "rx": G * TORSION / h,
        "ry": E * ABOUT_Y / h,
        "rz": E * ABOUT_Z / h,
    }
    nodes = {f"n{i}": (i * h, 0.0, 0.0) for i in range(pieces + 1)}
    masses = {name: slice_of_bar(i * h, h) for i, name in enumerate(nodes)}
    springs = [{"between": (f"n{i}", f"n{i + 1}"), "stiffness": stiffness} for i in range(pieces)]
    return elastic(prs.reduce("lumped", nodes=nodes, masses=masses, springs=springs))


def slice_of_bar(x: float, h: float) -> dict[str, Any]:
    """The bar from x - h/2 to x + h/2, as far as there is any."""
    low, high = max(x - h / 2.0, 0.0), min(x + h / 2.0, LENGTH)
    mass, width = DENSITY * AREA * (high - low), high - low
    inertia = {"xx": mass * POLAR, "yy": mass * (width**2 + Z**2) / 12.0, "zz": mass * (width**2 + Y**2) / 12.0}
    return {"mass": mass, "centre": ((low + high) / 2.0, 0.0, 0.0), "inertia": inertia}


def elastic(part: FiniteElementModel | SuperElement) -> np.ndarray:
    """Free frequencies [Hz] without the six of rigid motion."""
    if isinstance(part, FiniteElementModel):
        return part.frequencies(14)[6:]
    return summarize(part, 8).free


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> dict[str, np.ndarray]:
    ways = {"solid": solid(tmp_path_factory.mktemp("mesh")), "beam": beam()}
    return ways | {f"lumped {n}": lumped(n) for n in PIECES}


def test_side_by_side(found: dict[str, np.ndarray]) -> None:
    print("\nfree frequencies / Hz\n" + f"{'':16}" + "".join(f"{way:>12}" for way in found))
    for k, mode in enumerate(MODES):
        print(f"{mode:<16}" + "".join(f"{values[k]:12.1f}" for values in found.values()))
    np.testing.assert_allclose(found["beam"][:5], found["solid"][:5], rtol=3e-3)
    bending = [0, 1, 3, 4]
    errors = [1.0 - found[f"lumped {n}"][bending] / found["beam"][bending] for n in PIECES]
    assert np.all(errors[2] > 0.0)
    assert np.log2(errors[0] / errors[1])[:2] == pytest.approx(2.0, abs=0.15)
    assert np.log2(errors[1] / errors[2]) == pytest.approx(2.0, abs=0.15)


def test_along_and_about_the_axis(found: dict[str, np.ndarray]) -> None:
    axial = np.sqrt(E / DENSITY) / (2.0 * LENGTH)
    torsion = np.sqrt(G * TORSION / (DENSITY * AREA * POLAR)) / (2.0 * LENGTH)
    love = 1.0 / np.sqrt(1.0 + NU**2 * POLAR * (np.pi / LENGTH) ** 2)
    assert found["beam"][[2, 5]] == pytest.approx([torsion, axial], rel=6e-4)
    assert found["solid"][5] == pytest.approx(love * axial, rel=2e-4)
    assert found["solid"][2] == pytest.approx(torsion, rel=5e-3)
    for pieces in PIECES[1:]:
        coarse = np.sinc(0.5 / pieces)
        for exact in (axial, torsion):
            nearest = found[f"lumped {pieces}"][np.argmin(np.abs(found[f"lumped {pieces}"] - coarse * exact))]
            assert nearest == pytest.approx(coarse * exact, rel=1e-6)
