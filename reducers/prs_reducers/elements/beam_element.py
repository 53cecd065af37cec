"""The spatial Timoshenko beam element: exact statics, and the consistent mass of its static shapes."""

from __future__ import annotations

import numpy as np

from prs_model.arrays import FloatArray
from prs_model.finite_elements.rigid_motion import transfer

from .beam_sections import CrossSection

# places of (w1, slope1, w2, slope2) among ux uy uz rx ry rz of both ends; in the x-z plane the slope is -ry
IN_XY, IN_XZ = [1, 5, 7, 11], [2, 4, 8, 10]
AXIAL, TWIST = [0, 6], [3, 9]
SLOPE_SIGN = np.array([1.0, -1.0, 1.0, -1.0])


def beam_matrices(section: CrossSection, length: float) -> tuple[FloatArray, FloatArray]:
    """K and M (12, 12) of a beam along local x, ends one after the other [SI].

    J. S. Przemieniecki, Theory of Matrix Structural Analysis, 1968, sec. 5.6 and 11.5, with the mass of Z. Friedman and
    J. B. Kosmatka, An improved two-node Timoshenko beam finite element, Comput. Struct. 47, 1993.
    """
    K, M = np.zeros((12, 12)), np.zeros((12, 12))
    polar = section.inertia[0] + section.inertia[1]
    for rows, stiffness, mass in ((AXIAL, section.axial, section.mass), (TWIST, section.torsion, polar)):
        K[np.ix_(rows, rows)] = stiffness / length * np.array([[1.0, -1.0], [-1.0, 1.0]])
        M[np.ix_(rows, rows)] = mass * length / 6.0 * np.array([[2.0, 1.0], [1.0, 2.0]])
    planes = (
        (IN_XY, np.ones(4), section.bending[1], section.shear[0], section.inertia[1]),
        (IN_XZ, SLOPE_SIGN, section.bending[0], section.shear[1], section.inertia[0]),
    )
    for rows, sign, bending, shear, inertia in planes:
        k, m = plane_bending(length, bending, shear, section.mass, inertia)
        K[np.ix_(rows, rows)], M[np.ix_(rows, rows)] = k * np.outer(sign, sign), m * np.outer(sign, sign)
    return K, M


def plane_bending(
    length: float, bending: float, shear: float, mass: float, inertia: float
) -> tuple[FloatArray, FloatArray]:
    """K and M (4, 4) in one plane on (w1, slope1, w2, slope2), from EI, kGA, mass and rotary inertia per metre.

    M = int mass w w + inertia theta theta dx over the shapes that end loads give the beam (eq. 21-24 of Friedman and
    Kosmatka), with phi = 12 EI / kGA L^2; four Gauss points are exact.
    """
    L, phi = length, 12.0 * bending / (shear * length**2)
    K = (bending / ((1.0 + phi) * L**3)) * np.array(
        [
            [12.0, 6.0 * L, -12.0, 6.0 * L],
            [6.0 * L, (4.0 + phi) * L**2, -6.0 * L, (2.0 - phi) * L**2],
            [-12.0, -6.0 * L, 12.0, -6.0 * L],
            [6.0 * L, (2.0 - phi) * L**2, -6.0 * L, (4.0 + phi) * L**2],
        ]
    )
    points, weights = np.polynomial.legendre.leggauss(4)
    deflection, rotation = static_shapes((points + 1.0) / 2.0, L, phi)
    weights = weights * L / 2.0
    M = mass * (deflection * weights) @ deflection.T + inertia * (rotation * weights) @ rotation.T
    return K, M


def static_shapes(x: FloatArray, length: float, phi: float) -> tuple[FloatArray, FloatArray]:
    """Deflection and rotation of the section (4, q) at x (q,) of the length, for units of (w1, slope1, w2, slope2)."""
    L = length
    deflection = [
        2.0 * x**3 - 3.0 * x**2 - phi * x + 1.0 + phi,
        L * (x**3 - (2.0 + phi / 2.0) * x**2 + (1.0 + phi / 2.0) * x),
        -2.0 * x**3 + 3.0 * x**2 + phi * x,
        L * (x**3 - (1.0 - phi / 2.0) * x**2 - phi / 2.0 * x),
    ]
    rotation = [
        6.0 / L * (x**2 - x),
        3.0 * x**2 - (4.0 + phi) * x + 1.0 + phi,
        6.0 / L * (x - x**2),
        3.0 * x**2 - (2.0 - phi) * x,
    ]
    return np.array(deflection) / (1.0 + phi), np.array(rotation) / (1.0 + phi)


def at_nodes(axes: FloatArray, offsets: FloatArray) -> FloatArray:
    """(12, 12): motions of the ends in local axes (3, 3) from those of two nodes, which are rigidly joined to them.

    offsets: (2, 3), from each node to its end [m].
    """
    turn = np.kron(np.eye(2), axes.T)
    whole = np.zeros((12, 12))
    whole[:6, :6], whole[6:, 6:] = turn @ transfer(offsets[0]), turn @ transfer(offsets[1])
    return whole
