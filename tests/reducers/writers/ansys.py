"""ANSYS' exports of matrices and nodes, and the public rotor, whose file lacks its coordinates."""

from __future__ import annotations

import numpy as np
from scipy.sparse import tril

from prs_model.arrays import FloatArray, IntArray
from prs_model.part_files import LabelledMatrices
from tests.superelements import DATA

ROTOR = DATA / "ansys" / "sparse.full"
HEIGHT = 0.5  # m, of the rotor
FOOT = {"foot": {"plane": {"point": [0.0, 0.0, 0.0], "normal": [0.0, 0.0, 1.0], "tolerance": 1e-6}}}


def places_of(rotor: LabelledMatrices) -> tuple[IntArray, FloatArray]:
    """Nodes and coordinates, which are not in the file. K is at rest in six motions only: turning about x moves every
    node by (0, -z, y), about y by (z, 0, -x), so the shape is in K's null space; its height is known.
    """
    motions = np.linalg.eigh(rotor.stiffness.toarray())[1][:, :6].reshape(-1, 3, 6)
    turns = np.linalg.svd((motions - motions.mean(axis=0)).reshape(-1, 6), full_matrices=False)[0][:, :3]
    about = [turns @ np.linalg.svd(turns[axis::3])[2][-1] for axis in (0, 1)]
    (_, minus_z, y), (z, _, minus_x) = (motion.reshape(-1, 3).T for motion in about)
    points = np.column_stack([minus_x * (minus_z @ z) / (z @ z), y, -minus_z])
    points *= HEIGHT / np.ptp(points[:, 2])
    weights = rotor.mass.sum(axis=1)[2::3]
    if weights @ points[:, 2] < weights.sum() * points[:, 2].mean():  # the disc sits near the foot
        points = points - points[:, 2].min() * np.array([0.0, 0.0, 1.0])
    else:
        points = -points + points[:, 2].max() * np.array([0.0, 0.0, 1.0])
    return rotor.nodes[::3], points


def listing(nodes: IntArray, points: FloatArray) -> str:
    """A node table as Workbench exports it in German."""
    rows = ["\t".join([str(node), *(f"{value:.12e}".replace(".", ",") for value in place)]) for node, place in
            zip(nodes.tolist(), points, strict=True)]  # fmt: skip
    return "Knotennummer\tX-Position (m)\tY-Position (m)\tZ-Position (m)\t\n" + "\t\n".join(rows) + "\t\n"


def market(matrix: FloatArray) -> str:
    """One triangle as *EXPORT,..,MMF writes it."""
    half = tril(matrix).tocoo()
    rule = "%" + 60 * "="
    head = f"%%MatrixMarket matrix coordinate real symmetric \n{rule}\n% Creator: ANSYS Inc\n% \n{rule}\n"
    rows, columns = half.coords
    entries = [f"{i + 1} {j + 1} {v:.15E}" for i, j, v in zip(rows, columns, half.data, strict=True)]
    return head + f"{matrix.shape[0]} {matrix.shape[0]} {half.nnz}\n" + "\n".join(entries) + "\n"


def back(nodes: IntArray) -> str:
    """A vector of integers as *EXPORT,..,MMF writes it."""
    return f"%%MatrixMarket matrix array integer general \n% Creator: ANSYS Inc\n{len(nodes)} 1\n" + "".join(
        f"{node}\n" for node in nodes
    )


def mapping(nodes: IntArray, components: IntArray) -> str:
    """What HBMAT says of the rows."""
    rows = enumerate(zip(nodes, components, strict=True), start=1)
    lines = [f"{row:14d}{node:14d}  {('UX', 'UY', 'UZ')[component]}" for row, (node, component) in rows]
    return "  Matrix Eqn          Node   DOF\n" + "\n".join(lines) + "\n"
