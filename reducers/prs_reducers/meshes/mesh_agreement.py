"""Whether matrices are those of a mesh: what the physics of solids lets one see, row by row, also in a held part."""

from __future__ import annotations

import numpy as np
from scipy.sparse import csr_array

from prs_model.arrays import BoolArray, FloatArray, IntArray
from prs_model.errors import PartFileError, short
from prs_model.finite_elements import FiniteElementModel
from prs_model.part_files import LabelledMatrices
from prs_model.reduction.super_element import AXES

from .labelled_mesh import LabelledMesh

RESISTING = 1e-7
"""A row's force in rigid motion, over the sum of its terms' sizes, that is more than round-off of the file's digits."""
UNEQUAL = 1e-9
"""A difference between a mass along x and y, over the nodes' own, that is more than round-off of the file's digits."""
TOO_MUCH = 1e-6
"""What a mass between two motions may exceed their own by: digits of the file, turned into other axes."""
FEW = 30
"""Rows that one damaged number or line can reach."""


def check_against_mesh(model: FiniteElementModel, mesh: LabelledMesh, matrices: LabelledMatrices) -> None:
    """Raises PartFileError for a row of a solid that no solid has.

    A row without stiffness or mass; nodes that act on each other without a common element; a mass that differs along
    x, y and z; rigid motion that costs energy where no held node is near. Shells and beams must have mass too, and no
    mass between two motions may exceed their own.
    """
    _check_complete(model, mesh, matrices)
    _check_kinetic_energy(model, mesh, matrices)
    _check_neighbours(model, mesh, matrices)
    _check_mass(model, mesh, matrices)
    _check_rows_far_from_held(model, mesh, matrices)


def missing_rows(matrices: LabelledMatrices, mesh: LabelledMesh) -> IntArray:
    """(node, component) pairs (m, 2) of solid elements that have no row: motions that are held, or a truncated file."""
    places = mesh.table.places(matrices.nodes, matrices.source)
    there = np.zeros((len(mesh.table.labels), 6), dtype=bool)
    there[places, matrices.components] = True
    absent = ~there[mesh.in_solids, :3]
    rows, components = np.nonzero(absent)
    return np.column_stack([mesh.in_solids[rows], components])


def sentence_of(pairs: IntArray, mesh: LabelledMesh) -> str:
    """The first few of (node, 0..5) pairs, as ``10 uy, 14 uz ..``."""
    names = [_motion(pair, mesh) for pair in pairs[:4]]
    return short(", ".join(names)) + (" .." if len(pairs) > 4 else "")


def _check_complete(model: FiniteElementModel, mesh: LabelledMesh, matrices: LabelledMatrices) -> None:
    """Translations of solids have stiffness and mass; those of other elements with mass have it where they resist."""
    solid, weighing = np.zeros((2, len(model.coordinates)), dtype=bool)
    solid[mesh.in_solids] = True
    weighing[mesh.weighing] = True
    nodes, translation = model.dofs[:, 0], model.dofs[:, 1] < 3
    stiff, heavy = model.stiffness.diagonal() > 0.0, model.mass.diagonal() > 0.0
    lacking = {"stiffness": solid[nodes] & ~stiff, "mass": (solid[nodes] | weighing[nodes] & stiff) & ~heavy}
    for name, lacks in lacking.items():
        empty = np.flatnonzero(translation & lacks)
        if len(empty):
            label = mesh.table.labels[nodes[empty[0]]]
            raise PartFileError(
                matrices.source,
                f"{len(empty)} rows of elements with {name} have none, the first at node {label}: the {name} file is "
                "truncated, or of another part",
            )


def _check_kinetic_energy(model: FiniteElementModel, mesh: LabelledMesh, matrices: LabelledMatrices) -> None:
    """No two motions together have negative kinetic energy: m_ij^2 <= m_ii m_jj."""
    own, entries = np.sqrt(np.maximum(model.mass.diagonal(), 0.0)), model.mass.tocoo()
    rows, columns = entries.coords
    wrong = np.flatnonzero(np.abs(entries.data) > (1.0 + TOO_MUCH) * own[rows] * own[columns])
    if len(wrong):
        one, other = (_motion(model.dofs[at[wrong[0]]], mesh) for at in (rows, columns))
        raise PartFileError(
            matrices.source,
            f"the mass between {one} and {other} is more than their own allow: a number or line of the mass file is "
            "damaged or missing",
        )


def _motion(dof: IntArray, mesh: LabelledMesh) -> str:
    return f"{mesh.table.labels[dof[0]]} {AXES[dof[1]]}"


def _check_neighbours(model: FiniteElementModel, mesh: LabelledMesh, matrices: LabelledMatrices) -> None:
    """Nodes that act on each other are in one element, where nothing but solid elements joins them."""
    if mesh.tied or len(mesh.others) or not mesh.solids:
        return
    entries = model.stiffness.tocoo()
    rows, columns = entries.coords
    sizes = np.sqrt(np.abs(model.stiffness.diagonal()))
    strong = np.abs(entries.data) > UNEQUAL * sizes[rows] * sizes[columns]
    nodes = model.dofs[:, 0]
    acting = _pairs(nodes[rows[strong]], nodes[columns[strong]], len(model.coordinates))
    alone = np.transpose((acting > _joined(mesh)).nonzero())
    if len(alone):
        one, other = mesh.table.labels[alone[0]]
        raise PartFileError(
            matrices.source,
            f"nodes {one} and {other} act on each other, but share no element of {mesh.table.source.name}: rows in "
            "another order, a damaged element, or the mesh of another part",
        )


def _pairs(one: IntArray, other: IntArray, count: int) -> csr_array:
    """(count, count): true where a node of `one` meets the node of `other` beside it."""
    return csr_array((np.ones(len(one), dtype=bool), (one, other)), shape=(count, count))


def _joined(mesh: LabelledMesh) -> csr_array:
    """(k, k): true for nodes that are in one solid element."""
    elements = [element for nodes in mesh.solids.values() for element in nodes]
    number = np.repeat(np.arange(len(elements)), [len(element) for element in elements])
    count = len(mesh.table.labels)
    within = csr_array((np.ones(len(number)), (number, np.concatenate(elements))), shape=(len(elements), count))
    return csr_array(within.T @ within > 0)


def _check_mass(model: FiniteElementModel, mesh: LabelledMesh, matrices: LabelledMatrices) -> None:
    """A solid weighs the same along x, y and z: its mass is a number for each pair of nodes, times the identity.

    Not where constraints, which may act along one axis, move the mass of a node to others.
    """
    if mesh.tied:
        return
    only_solid = np.zeros(len(model.coordinates), dtype=bool)
    only_solid[np.setdiff1d(mesh.in_solids, mesh.others)] = True
    along = []
    whole = np.all(model.rows[:, :3] >= 0, axis=1) & only_solid
    for axis in range(3):
        rows = model.rows[whole, axis]
        along.append(model.mass[rows][:, rows])
    roots = np.sqrt(np.abs(along[0].diagonal()))
    for axis in (1, 2):
        apart = csr_array(along[axis] - along[0]).tocoo()
        row, column = apart.coords
        wrong = np.flatnonzero(np.abs(apart.data) > UNEQUAL * roots[row] * roots[column])
        if len(wrong):
            label = mesh.table.labels[np.flatnonzero(whole)[row[wrong[0]]]]
            raise PartFileError(
                matrices.source,
                f"the mass of node {label} differs along x and {'xyz'[axis]}, which that of a solid does not: rows in "
                "another order or a damaged number in the mass file",
            )


def _check_rows_far_from_held(model: FiniteElementModel, mesh: LabelledMesh, matrices: LabelledMatrices) -> None:
    """In rigid motion only nodes in an element with a held node resist; a row elsewhere that does is a wrong row.

    A part without a held node is left to the physics gate, unless a single row is wrong by too little for it.
    """
    near = _beside(mesh, missing_rows(matrices, mesh)[:, 0])
    held = bool(np.any(near))
    near[mesh.others] = True
    rows = np.flatnonzero(~near[model.dofs[:, 0]])
    bad = _resistance(model)[rows] > RESISTING
    if np.any(bad) and (held or np.count_nonzero(bad) <= FEW):
        node, component = model.dofs[rows[np.argmax(bad)]]
        raise PartFileError(
            matrices.source,
            f"{np.count_nonzero(bad)} rows resist rigid motion though no held node is near (the first is node "
            f"{mesh.table.labels[node]} {AXES[component]}): rows in another order, a damaged number, or the mesh "
            "of another part",
        )


def _beside(mesh: LabelledMesh, held: IntArray) -> BoolArray:
    """Nodes that share an element with a held one."""
    is_held, near = np.zeros((2, len(mesh.table.labels)), dtype=bool)
    is_held[held] = True
    for nodes in mesh.solids.values():
        near[nodes[np.any(is_held[nodes], axis=1)]] = True
    return near


def _resistance(model: FiniteElementModel) -> FloatArray:
    """(n,): |K phi| over |K| |phi|, term by term, the largest of six rigid motions."""
    phi = model.rigid_body_modes(about=model.coordinates.mean(axis=0))
    size = csr_array(abs(model.stiffness)) @ abs(phi)
    return np.asarray(np.max(np.abs(model.stiffness @ phi) / np.where(size > 0.0, size, 1.0), axis=1))
