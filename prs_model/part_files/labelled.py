"""Matrices as a solver wrote them, each row with its node and component, made into SI models and super-elements."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, eye_array

from ..arrays import FloatArray, IntArray
from ..description.units import Dimension, Units
from ..errors import PartFileError
from ..finite_elements import FiniteElementModel
from ..reduction.super_element import AXES, SuperElement

MODE = -1
"""The component of a modal coordinate."""

UNIT_AXES = 1e-6
"""How far axes of unit length may be from it, and from right angles."""

ENERGY, INERTIA = Dimension(force=1, length=1), Dimension(mass=1, length=2)
LENGTH, MASS = Dimension(length=1), Dimension(mass=1)


@dataclass(frozen=True, eq=False)
class LabelledMatrices:
    """Stiffness and mass of one part in the units of its file, with what each row stands for.

    stiffness, mass: (n, n), dense or sparse, both triangles filled. nodes: (n,) the label of each row's node (a number
    or a name; of a modal coordinate, its own). components: (n,), 0..5 for ux..rz in the node's output frame, or MODE.
    Raises PartFileError when shapes disagree, a row is named twice, or a number is not finite.
    """

    source: Path
    stiffness: csr_array | FloatArray
    mass: csr_array | FloatArray
    nodes: NDArray[Any]
    components: IntArray

    def __post_init__(self) -> None:
        n = len(self.nodes)
        for name in ("stiffness", "mass"):
            matrix = getattr(self, name)
            if matrix.shape != (n, n):
                found = "x".join(map(str, matrix.shape))
                raise PartFileError(self.source, f"{name} is {found}, expected {n}x{n}, as many as rows are labelled")
            if not np.all(np.isfinite(_entries(matrix))):
                raise PartFileError(self.source, f"{name} holds numbers that are not finite: the file is damaged")
        if n == 0:
            raise PartFileError(self.source, "the matrices have no rows")
        whole = np.asarray(self.components).dtype.kind in "iu"
        if len(self.components) != n or not whole or not np.all((self.components >= MODE) & (self.components < 6)):
            raise PartFileError(self.source, "a row's component is none of ux..rz (0..5) or a mode")
        seen: set[tuple[str, int]] = set()
        for node, component in zip(self.nodes.tolist(), self.components.tolist(), strict=True):
            if (str(node), component) in seen:
                raise PartFileError(self.source, f"two rows are {_name(node, component)}")
            seen.add((str(node), component))

    @property
    def is_mode(self) -> NDArray[np.bool_]:
        """(n,): the rows of modal coordinates."""
        return np.asarray(self.components == MODE)


@dataclass(frozen=True, eq=False)
class NodeTable:
    """Where nodes are, in the units of their file.

    labels: (k,) numbers or names. coordinates: (k, 3). frames: (k, 3, 3) whose columns are the axes of each node's
    output frame in body axes; None where all of them are the body's. Raises PartFileError when shapes disagree, a node
    stands there twice, a coordinate is not finite, or axes are not right-handed, of unit length and at right angles.
    """

    source: Path
    labels: NDArray[Any]
    coordinates: FloatArray
    frames: FloatArray | None = None

    def __post_init__(self) -> None:
        if self.coordinates.shape != (len(self.labels), 3) or not np.all(np.isfinite(self.coordinates)):
            raise PartFileError(self.source, f"expected three finite coordinates for each of {len(self.labels)} nodes")
        labels, counts = np.unique(self.labels.astype(str), return_counts=True)
        if np.any(counts > 1):
            raise PartFileError(self.source, f"node {labels[np.argmax(counts)]} stands there twice")
        if self.frames is not None:
            self._check_frames(self.frames)

    def _check_frames(self, frames: FloatArray) -> None:
        if frames.shape != (len(self.labels), 3, 3):
            raise PartFileError(self.source, f"frames are {frames.shape}, expected ({len(self.labels)}, 3, 3)")
        away = np.abs(frames.transpose(0, 2, 1) @ frames - np.eye(3)).max(axis=(1, 2), initial=0.0)
        third = np.cross(frames[:, :, 0], frames[:, :, 1])
        wrong = ~(away <= UNIT_AXES) | (np.sum(third * frames[:, :, 2], axis=1) < 0.0)
        if np.any(wrong):
            node = self.labels[np.argmax(wrong)]
            raise PartFileError(
                self.source, f"the axes of node {node} are not right-handed, of unit length and at right angles"
            )

    def places(self, labels: NDArray[Any], asked_by: Path) -> IntArray:
        """(m,) where these nodes stand in the table. Raises PartFileError naming those that do not."""
        place = {str(label): index for index, label in enumerate(self.labels.tolist())}
        wanted = [str(label) for label in labels.tolist()]
        missing = sorted({label for label in wanted if label not in place})
        if missing:
            listed = ", ".join(missing[:5]) + (" .." if len(missing) > 5 else "")
            raise PartFileError(
                asked_by, f"{len(missing)} of its nodes have no coordinates in {self.source.name}: {listed}"
            )
        return np.array([place[label] for label in wanted], dtype=np.int64)


def full_model(
    matrices: LabelledMatrices,
    table: NodeTable,
    units: Units,
    *,
    node_sets: Mapping[str, IntArray] | None = None,
    triangles: IntArray | None = None,
    provenance: Mapping[str, str] | None = None,
) -> FiniteElementModel:
    """The finite-element model of full matrices, in SI and in body axes.

    node_sets, triangles: by places in the table. Rows of nodes with an output frame are turned to body axes. Raises
    PartFileError for modal rows, nodes without coordinates, or a turned node without all three axes.
    """
    if np.any(matrices.is_mode):
        raise PartFileError(matrices.source, "it has modal coordinates: an already reduced part, expected a full one")
    at = table.places(matrices.nodes, matrices.source)
    stiffness, mass = _in_si(matrices, units)
    if table.frames is not None:
        turn = _turn(matrices, at, table.frames)
        stiffness, mass = turn @ stiffness @ turn.T, turn @ mass @ turn.T
    return FiniteElementModel(
        stiffness=csr_array(stiffness),
        mass=csr_array(mass),
        coordinates=table.coordinates * LENGTH.factor(units),
        dofs=np.column_stack([at, matrices.components]),
        node_ids=table.labels,
        node_sets=node_sets or {},
        triangles=triangles,
        provenance=provenance or {},
    )


def super_element(
    matrices: LabelledMatrices,
    table: NodeTable,
    units: Units,
    *,
    grounded: bool = False,
    modes: str = "",
    node_sets: Mapping[str, tuple[str, ...]] | None = None,
    provenance: Mapping[str, str] | None = None,
) -> SuperElement:
    """The super-element of reduced matrices: their nodes by label, ordered as first met, then the modal coordinates.

    modes: "fixed-interface" where the file promises modes that are mass-normalised and elastically uncoupled from the
    nodes, which the physics gate then asks for. A node may lack components: those motions are empty rows.
    Raises PartFileError for nodes without coordinates, or when no row belongs to a node.
    """
    labels = list(dict.fromkeys(matrices.nodes[~matrices.is_mode].tolist()))
    if not labels:
        raise PartFileError(matrices.source, "no row belongs to a node, so that nothing can take hold of the part")
    order = _order(matrices, labels)
    matrices = replace(
        matrices,
        stiffness=_dense(matrices.stiffness)[np.ix_(order, order)],
        mass=_dense(matrices.mass)[np.ix_(order, order)],
        nodes=matrices.nodes[order],
        components=matrices.components[order],
    )
    at = table.places(np.array(labels), matrices.source)
    stiffness, mass = _in_si(matrices, units)
    names = [_name(node, component) for node, component in zip(matrices.nodes, matrices.components, strict=True)]
    said = {**(provenance or {}), **({"modes": modes} if modes else {})}
    return SuperElement(
        stiffness=_dense(stiffness),
        mass=_dense(mass),
        nodes=tuple(map(str, labels)),
        positions=table.coordinates[at] * LENGTH.factor(units),
        motions=_motions(matrices, labels, None if table.frames is None else table.frames[at]),
        n_modes=int(np.count_nonzero(matrices.is_mode)),
        grounded=grounded,
        labels=tuple(names),
        node_sets=node_sets or {},
        provenance=said,
    )


def in_file_units(
    stiffness: FloatArray, mass: FloatArray, components: IntArray, units: Units
) -> tuple[FloatArray, FloatArray]:
    """Matrices (n, n) of SI in `units`; modal coordinates stay mass-normalised. What `super_element` does, undone."""
    scales = si_scales(components, units)
    square = np.outer(scales, scales)
    return stiffness * (square / ENERGY.factor(units)), mass * (square / INERTIA.factor(units))


def si_scales(components: IntArray, units: Units) -> FloatArray:
    """(n,): a coordinate in SI is its number in the file times this; modes are mass-normalised in the file's units."""
    length = LENGTH.factor(units)
    scales = np.where(components < 3, length, 1.0)
    return np.where(components == MODE, np.sqrt(MASS.factor(units)) * length, scales)


def _in_si(matrices: LabelledMatrices, units: Units) -> tuple[Any, Any]:
    """Energies are u^T K u and v^T M v, so each entry takes the factor of energy over those of its coordinates."""
    scales = si_scales(matrices.components, units)
    stiffness = _scaled(matrices.stiffness, scales, ENERGY.factor(units))
    return stiffness, _scaled(matrices.mass, scales, INERTIA.factor(units))


def _scaled(matrix: csr_array | FloatArray, scales: FloatArray, factor: float) -> Any:
    if isinstance(matrix, np.ndarray):
        return matrix * (factor / np.outer(scales, scales))
    entries = matrix.tocoo()
    rows, columns = entries.coords
    return csr_array((entries.data * (factor / (scales[rows] * scales[columns])), (rows, columns)), shape=matrix.shape)


def _order(matrices: LabelledMatrices, labels: list[Any]) -> IntArray:
    """Rows by node, by component, modes last in the order they stand in."""
    rank = {label: index for index, label in enumerate(labels)}
    last = len(rank)
    first = [last if mode else rank[node] for node, mode in zip(matrices.nodes, matrices.is_mode, strict=True)]
    return np.lexsort((np.where(matrices.is_mode, 0, matrices.components), np.array(first)))


def _motions(matrices: LabelledMatrices, labels: list[Any], frames: FloatArray | None) -> FloatArray:
    """(k, 6, n): each node's motion in body axes from its coordinates in its output frame."""
    motions = np.zeros((len(labels), 6, len(matrices.nodes)))
    rank = {label: index for index, label in enumerate(labels)}
    for row, (node, component) in enumerate(zip(matrices.nodes.tolist(), matrices.components.tolist(), strict=True)):
        if component == MODE:
            continue
        axes = np.eye(3) if frames is None else frames[rank[node]]
        block = slice(0, 3) if component < 3 else slice(3, 6)
        motions[rank[node], block, row] = axes[:, component % 3]
    return motions


def _turn(matrices: LabelledMatrices, at: IntArray, frames: FloatArray) -> csr_array:
    """R (n, n) with u_body = R u_file; a turned node has all three axes of what it has, or it cannot be turned."""
    n = len(matrices.nodes)
    turn: Any = eye_array(n, format="lil")
    turned = np.any(np.abs(frames - np.eye(3)) > 1e-12, axis=(1, 2))
    rows = {
        (int(place), int(component)): row
        for row, (place, component) in enumerate(zip(at, matrices.components, strict=True))
    }
    for place in np.unique(at[turned[at]]):
        for first in (0, 3):
            there = [rows[place, c] for c in range(first, first + 3) if (place, c) in rows]
            if there and len(there) < 3:
                raise PartFileError(
                    matrices.source,
                    f"node {matrices.nodes[there[0]]} has an output frame of its own, but only some of its axes are "
                    "there: export all three",
                )
            if there:
                turn[np.ix_(there, there)] = frames[place]
    return csr_array(turn)


def _dense(matrix: Any) -> FloatArray:
    return matrix if isinstance(matrix, np.ndarray) else np.asarray(matrix.toarray())


def _entries(matrix: Any) -> FloatArray:
    return matrix if isinstance(matrix, np.ndarray) else np.asarray(matrix.data)


def _name(node: Any, component: int) -> str:
    return f"mode {node}" if component == MODE else f"{node}.{AXES[component]}"
