"""Small meshes made in code: boxes of ten-node tetrahedra with their six sides as named surfaces."""

from __future__ import annotations

from collections.abc import Callable
from itertools import permutations
from pathlib import Path

import meshio
import numpy as np

from prs_model.arrays import FloatArray, IntArray
from prs_model.description.schema import Section
from prs_model.finite_elements import FiniteElementModel
from prs_reducers.elements.tetrahedra import outer_faces
from prs_reducers.meshes.mesh_file import TetrahedralMesh
from prs_reducers.solid import SolidOptions, solid_model

EDGES = ((0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3))  # mid-side nodes 4..9 in VTK's order
STEEL = {"E": 2.1e11, "nu": 0.3, "density": 7850.0}


def box(
    size: tuple[float, float, float],
    cells: tuple[int, int, int],
    *,
    quadratic: bool = True,
    shape: Callable[[FloatArray], FloatArray] = lambda points: points,
) -> TetrahedralMesh:
    """A box from the origin, each cell cut into six tetrahedra. Surfaces x0, x1, y0, y1, z0, z1; volume 'all'.

    shape: maps points of the box (n, 3) to where they shall be, mid-side nodes too (so elements may be curved).
    """
    points, elements = _corners(size, cells)
    faces = outer_faces(elements)
    sides = {
        f"{'xyz'[axis]}{end}": np.all(np.isclose(points[faces, axis], end * size[axis]), axis=1)
        for axis in range(3)
        for end in (0, 1)
    }
    if quadratic:
        points, elements, faces = _with_midsides(points, elements, faces)
    return TetrahedralMesh(
        source=Path("box.msh"),
        points=shape(points),
        elements=elements,
        groups={name: faces[chosen] for name, chosen in sides.items()} | {"all": elements},
        surfaces=frozenset(sides),
        volumes={"all": np.arange(len(elements))},
    )


def steel(mesh: TetrahedralMesh, **material: float) -> FiniteElementModel:
    """The finite-element model of a mesh in metres, of steel unless said otherwise."""
    options: Section = SolidOptions.model_validate({"material": STEEL | material})
    assert isinstance(options, SolidOptions)
    return solid_model(mesh, options)


def write(mesh: TetrahedralMesh, path: Path, scale: float = 1.0) -> Path:
    """Write a mesh with its groups as gmsh's physical groups; `scale` multiplies its lengths."""
    kinds = {3: "triangle", 6: "triangle6", 4: "tetra", 10: "tetra10"}
    cells, tags, names = [], [], {}
    for tag, (name, nodes) in enumerate(mesh.groups.items(), start=1):
        cells.append((kinds[nodes.shape[1]], nodes))
        tags.append(np.full(len(nodes), tag))
        names[name] = np.array([tag, 2 if name in mesh.surfaces else 3])
    data = {"gmsh:physical": tags, "gmsh:geometrical": tags}
    meshio.write_points_cells(path, mesh.points * scale, cells, cell_data=data, field_data=names, file_format="gmsh22")
    return path


def _corners(size: tuple[float, float, float], cells: tuple[int, int, int]) -> tuple[FloatArray, IntArray]:
    axes = [np.linspace(0.0, length, count + 1) for length, count in zip(size, cells, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    number = np.arange(len(points)).reshape([count + 1 for count in cells])
    first = np.stack(np.meshgrid(*map(np.arange, cells), indexing="ij"), axis=-1).reshape(-1, 3)
    elements = []
    for order in permutations(range(3)):
        path = np.zeros((4, 3), dtype=int)
        for step, axis in enumerate(order):
            path[step + 1 :, axis] = 1
        if np.linalg.det(path[1:] - path[0]) < 0:
            path = path[[0, 2, 1, 3]]
        corners = first[:, None, :] + path
        elements.append(number[corners[..., 0], corners[..., 1], corners[..., 2]])
    return points, np.concatenate(elements)


def _with_midsides(points: FloatArray, elements: IntArray, faces: IntArray) -> tuple[FloatArray, IntArray, IntArray]:
    edges = np.sort(elements[:, np.array(EDGES)].reshape(-1, 2), axis=1)
    unique, place = np.unique(edges, axis=0, return_inverse=True)
    middle = len(points) + place.reshape(-1, 6)
    number = {(int(a), int(b)): len(points) + i for i, (a, b) in enumerate(unique)}
    midsides = [
        [number[(min(a, b), max(a, b))] for a, b in ((f[0], f[1]), (f[1], f[2]), (f[2], f[0]))] for f in faces.tolist()
    ]
    points = np.concatenate([points, points[unique].mean(axis=1)])
    return points, np.hstack([elements, middle]), np.hstack([faces, np.array(midsides)])
