"""What a SAMCEF user can hand over of a small part, as text."""

from __future__ import annotations

import numpy as np

from prs_model.arrays import FloatArray
from prs_model.finite_elements.rigid_motion import transfer

POINTS = np.array([[0.0, 0.0, 0.0], [300.0, 100.0, 0.0]])  # mm
AXES = ("ux", "uy", "uz", "rx", "ry", "rz")


def matrices() -> tuple[FloatArray, FloatArray]:
    """A free part of 4 kg on two nodes of six motions, with one fixed-interface mode of 300 Hz; N, mm, tonne."""
    rigid = transfer(POINTS).reshape(12, 6)
    inner = np.linalg.svd(rigid)[0][:, 6:]
    stiffness, mass = np.zeros((13, 13)), np.eye(13)
    stiffness[:12, :12] = (inner * np.linspace(1e3, 2e3, 6)) @ inner.T
    stiffness[12, 12] = (2.0 * np.pi * 300.0) ** 2
    mass[:12, :12] = np.diag([2e-3, 2e-3, 2e-3, 3.0, 3.0, 3.0] * 2)
    return stiffness, mass


def fortran(matrix: FloatArray, each: int = 4) -> str:
    values = [f"{value: .16E}".replace("E", "D") for value in matrix.ravel()]
    return "\n".join(" ".join(values[at : at + each]) for at in range(0, len(values), each)) + "\n"


def table(places: bool) -> str:
    lines = ["! row node component x y z"]
    for node, place in zip((11, 23), POINTS, strict=True):
        for axis in AXES:
            where = " ".join(map(str, place)) if places else ""
            lines.append(f"{len(lines)} {node} {axis} {where}")
    return "\n".join([*lines, "13 1 mode"]) + "\n"


DECK = """.INIT &
! made by hand
.UNIT MM N T S
.NOE
 I 11 X 0. Y 0.  Z 0.0 ATT 1
 I 12 X 1.0D+02 Y 0.  Z 0.   I 13 X 2.+2 Y 0. Z 0.
 I 23 X 300. Y 100. Z 0.
.MAI
 I 1 N 11 12 13 0 23
.SEL GROUP 1 NOEUDS NOM "BORE"
 I 11 12 $
 13
.SEL GROUP 2 MAILLES NOM "ALL" TOUT
.SEL
 GROUP 3 NOM "TIP" NOEUD
 I 23
RETURN
"""
