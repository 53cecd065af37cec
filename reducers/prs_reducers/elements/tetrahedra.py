"""Stiffness and mass of solid tetrahedra, four- or ten-node, straight or curved (scikit-fem's shape functions)."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.sparse import coo_array, csr_array

from prs_model.arrays import FloatArray, IntArray
from prs_model.errors import MissingExtraError

# corners of a tetrahedron's faces, seen from outside, and the mid-side nodes between them (VTK's order)
FACES = np.array([[0, 2, 1, 6, 5, 4], [0, 1, 3, 4, 8, 7], [1, 2, 3, 5, 9, 8], [0, 3, 2, 7, 9, 6]])
CHUNK = 4000  # elements at a time, to bound memory


@dataclass(frozen=True)
class Material:
    """Isotropic elasticity, SI."""

    E: float
    nu: float
    density: float

    @property
    def lame(self) -> tuple[float, float]:
        """lambda and mu [Pa]."""
        return self.E * self.nu / (1.0 + self.nu) / (1.0 - 2.0 * self.nu), self.E / 2.0 / (1.0 + self.nu)


def assemble(
    points: FloatArray, elements: IntArray, material: Material, *, mass_order: int = 6
) -> tuple[csr_array, csr_array]:
    """K and consistent M, (3 n, 3 n), of elements (e, 4 or 10) over points (n, 3) [m]; rows are 3 node + component.

    mass_order: degree to which the mass is integrated; 4 is exact on straight elements, CalculiX uses 2.

    Raises MissingExtraError without scikit-fem, ValueError naming an element that is flat or turned inside out.
    """
    n = 3 * len(points)
    stiffness, mass = csr_array((n, n)), csr_array((n, n))
    for start in range(0, len(elements), CHUNK):
        chunk = elements[start : start + CHUNK]
        rows = (3 * chunk[:, :, None] + np.arange(3)).reshape(len(chunk), -1)
        stiffness = stiffness + _scatter(element_stiffness(points[chunk], material), rows, n)
        mass = mass + _scatter(element_mass(points[chunk], material, mass_order), rows, n)
    return stiffness, mass


def element_stiffness(corners: FloatArray, material: Material) -> FloatArray:
    """(e, 3 m, 3 m) for nodes (e, m, 3): int lambda div u div v + 2 mu eps(u) : eps(v), with four points for m = 10."""
    _, gradients, volumes = _shape(corners, order=2 if corners.shape[1] == 10 else 1)
    e, q, m, _ = gradients.shape
    flat = gradients.reshape(e, q, 3 * m)
    products = np.matmul((flat * volumes[..., None]).transpose(0, 2, 1), flat).reshape(e, m, 3, m, 3)
    lam, mu = material.lame
    shear = np.einsum("eicjc->eij", products)
    stiffness = lam * products + mu * products.transpose(0, 1, 4, 3, 2)
    for axis in range(3):
        stiffness[:, :, axis, :, axis] += mu * shear
    return np.asarray(stiffness.reshape(e, 3 * m, 3 * m))


def element_mass(corners: FloatArray, material: Material, order: int = 6) -> FloatArray:
    """(e, 3 m, 3 m) for nodes (e, m, 3): int rho u v; order 6 has fifteen points of positive weight."""
    values, _, volumes = _shape(corners, order)
    m = corners.shape[1]
    scalar = material.density * np.einsum("qi,qj,eq->eij", values, values, volumes, optimize=True)
    mass = np.zeros((len(corners), m, 3, m, 3))
    for axis in range(3):
        mass[:, :, axis, :, axis] = scalar
    return mass.reshape(len(corners), 3 * m, 3 * m)


def outer_faces(elements: IntArray) -> IntArray:
    """(t, 3) or (t, 6) nodes of the faces that only one element (e, 4 or 10) has, outward, corners first.

    Raises ValueError when more than two elements share a face.
    """
    width = 6 if elements.shape[1] == 10 else 3
    faces = elements[:, FACES[:, :width]].reshape(-1, width)
    _, first, count = np.unique(np.sort(faces[:, :3], axis=1), axis=0, return_index=True, return_counts=True)
    if np.any(count > 2):
        raise ValueError(
            f"{np.count_nonzero(count > 2)} faces belong to more than two elements: some are in the file twice, "
            "as when overlapping volumes are meshed; keep one of each"
        )
    return np.asarray(faces[np.sort(first[count == 1])])


def face_areas(points: FloatArray, faces: IntArray) -> FloatArray:
    """(n,) share of each point in the area of faces (f, 3 or 6): a third per corner, or per mid-side node of six."""
    corners = points[faces[:, :3]]
    areas = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2.0
    bearing = faces[:, -3:]
    shares = np.bincount(bearing.ravel(), weights=np.repeat(areas / 3.0, 3), minlength=len(points))
    return np.asarray(shares, dtype=float)


def _shape(corners: FloatArray, order: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Shape functions (q, m), their gradients (e, q, m, 3) [1/m] and the volume of each point (e, q) [m^3]."""
    values, local, weights = _reference(corners.shape[1], order)
    jacobian = np.einsum("emi,qmk->eqik", corners, local)
    determinant = np.linalg.det(jacobian)
    bad = np.flatnonzero(np.any(determinant <= 0.0, axis=1))
    if len(bad):
        raise ValueError(
            f"{len(bad)} elements are flat or turned inside out, the first with a node at {corners[bad[0], 0]} m"
        )
    gradients = np.einsum("qmk,eqki->eqmi", local, np.linalg.inv(jacobian), optimize=True)
    return values, gradients, determinant * weights


def _reference(nodes: int, order: int) -> tuple[FloatArray, FloatArray, FloatArray]:
    """On the reference tetrahedron: shape functions (q, m), derivatives (q, m, 3), weights (q,)."""
    try:
        from skfem import ElementTetP1, ElementTetP2
        from skfem.quadrature import get_quadrature
    except ImportError as error:
        raise MissingExtraError("scikit-fem", "fem", "assembling a solid") from error
    element = ElementTetP2() if nodes == 10 else ElementTetP1()
    points, weights = get_quadrature(element.refdom, order)
    basis = [element.lbasis(points, i) for i in range(nodes)]
    values = np.array([np.broadcast_to(value, weights.shape) for value, _ in basis]).T
    local = np.array([np.broadcast_to(np.asarray(slope), (3, len(weights))) for _, slope in basis]).transpose(2, 0, 1)
    return values, local, weights


def _scatter(blocks: FloatArray, rows: IntArray, n: int) -> csr_array:
    m = rows.shape[1]
    place = (np.repeat(rows, m, axis=1).ravel(), np.tile(rows, (1, m)).ravel())
    return csr_array(coo_array((blocks.ravel(), place), shape=(n, n)))
