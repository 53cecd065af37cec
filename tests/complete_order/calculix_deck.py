"""A machine as one CalculiX deck: every body's mesh in the world, interfaces averaged or rigid, the joints' springs.

From here come which nodes an interface has with what weights, where joints stand and their laws; elements, couplings,
springs and modes are ccx's. Rigid interfaces are its *RIGID BODY. Averages are written out as *EQUATION: in ccx 2.20
*DISTRIBUTING spreads loads only, *DISTRIBUTING COUPLING averages no rotations and MPC MEANROT takes no weights. A
spring is a SPRING1 to ground on a node that an *EQUATION moves by the relative displacement of the joint's ends.
"""

from __future__ import annotations

import re
import subprocess
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from prs_model.arrays import FloatArray, IntArray
from prs_model.complete_order import CompleteOrder
from prs_model.description.schema import Body
from prs_model.description.units import Dimension
from prs_model.joints import JointCompliance, Spring
from prs_model.kinematics import Configuration
from prs_model.reduction.coupling import Tie
from prs_model.reduction.request import asked
from prs_reducers.elements.tetrahedra import Material
from prs_reducers.meshes.mesh_file import read_mesh

Columns = tuple[IntArray, FloatArray]
"""Columns (m,) among the translations of all nodes, three each, and a motion's coefficients on them (6, m)."""


@dataclass(frozen=True, eq=False)
class PlacedMesh:
    """A mesh in the world: nodes and elements numbered on from `first`, points (n, 3) [m], elements (e, 10).

    Each tie has two nodes beyond those of the mesh, for its translation and its rotation, used where it is rigid.
    """

    name: str
    points: FloatArray
    elements: IntArray
    material: Material
    held: IntArray
    ties: tuple[Tie, ...] = ()
    first: int = 1

    def rigid_node(self, tie: Tie) -> int:
        """The node for the tie's translation; the next one is for its rotation."""
        return self.first + len(self.points) + 2 * self.ties.index(tie)

    @property
    def following(self) -> int:
        """The first number that is free."""
        return self.first + max(len(self.points) + 2 * len(self.ties), len(self.elements))


def frequencies(deck: str, folder: Path) -> FloatArray:
    """The frequencies [Hz], of seven digits, that ccx finds for a deck."""
    (folder / "job.inp").write_text(deck)
    run = subprocess.run(["ccx", "job"], cwd=folder, capture_output=True, text=True, check=False)
    table = (folder / "job.dat").read_text().split("P A R T I C")[0]
    found = re.findall(r"^ +\d+ +\S+ +\S+ +(\S+) +\S+$", table, re.MULTILINE)
    assert found, run.stdout[-2000:]
    return np.array(found, dtype=float)


def part_deck(mesh: PlacedMesh, count: int) -> str:
    """One part, for `count` modes."""
    return _text([*_mesh_lines(mesh), *_step_lines(count)])


def assembly_deck(complete: CompleteOrder, configuration: Configuration, count: int) -> str:
    """The complete order of a machine of `solid` parts in one configuration, for `count` modes."""
    meshes = _meshes(complete, configuration)
    values, placement = configuration.joint_values, configuration.placement
    springs = [spring for joint in complete.joints for spring in joint.springs(values, placement)]
    parts = [line for mesh in meshes.values() for line in _mesh_lines(mesh)]
    return _text([*parts, *_springs_lines(springs, meshes), *_step_lines(count)])


# ── parts ────────────────────────────────────────────────────────────────────────────────────────────


def _meshes(complete: CompleteOrder, configuration: Configuration) -> dict[str, PlacedMesh]:
    """The bodies' meshes with their interfaces as the complete order selects them, moved to the world."""
    meshes: dict[str, PlacedMesh] = {}
    following, folder = 1, complete.description.folder
    for name, part in complete.joined(configuration).bodies.items():
        body = complete.description.bodies[name]
        place = configuration.placement(body.frame)
        mesh = _read(name, body, folder)
        meshes[name] = replace(
            mesh,
            points=mesh.points @ place.rotation.T + place.translation,
            ties=tuple(replace(tie, position=np.asarray(place.act(tie.position))) for tie in part.ties),
            first=following,
        )
        following = meshes[name].following
    return meshes


def _read(name: str, body: Body, folder: Path) -> PlacedMesh:
    """The mesh of a body in its own frame."""
    request = asked(name, body, folder)[1]
    mesh, material = read_mesh(request.path), request.options.material
    return PlacedMesh(
        name=name,
        points=mesh.points * Dimension(length=1).factor(request.file_units),
        elements=mesh.elements,
        material=Material(float(material.E), float(material.nu), float(material.density)),
        held=np.unique(np.concatenate([np.zeros(0, dtype=int), *(mesh.groups[each].ravel() for each in body.clamped)])),
    )


def _mesh_lines(mesh: PlacedMesh) -> Iterator[str]:
    """Nodes, elements, material, held nodes and rigid bodies."""
    yield "*NODE"
    yield from (_node_line(node, point) for node, point in enumerate(mesh.points, start=mesh.first))
    yield f"*ELEMENT, TYPE=C3D10, ELSET={mesh.name}"
    numbers = mesh.first + np.arange(len(mesh.elements))
    yield from (", ".join(map(str, row)) for row in np.column_stack([numbers, mesh.first + mesh.elements]).tolist())
    yield from (f"*MATERIAL, NAME={mesh.name}", "*ELASTIC", f"{mesh.material.E}, {mesh.material.nu}")
    yield from ("*DENSITY", f"{mesh.material.density}", f"*SOLID SECTION, ELSET={mesh.name}, MATERIAL={mesh.name}")
    if len(mesh.held):
        yield from ("*BOUNDARY", *(f"{node}, 1, 3" for node in mesh.first + mesh.held))
    for tie in mesh.ties:
        if tie.coupling == "rigid":
            node = mesh.rigid_node(tie)
            yield from ("*NODE", _node_line(node, tie.position), _node_line(node + 1, tie.position))
            yield from (f"*NSET, NSET=N{node}", *(f"{each}," for each in mesh.first + tie.indices))
            yield f"*RIGID BODY, NSET=N{node}, REF NODE={node}, ROT NODE={node + 1}"


def _step_lines(count: int) -> tuple[str, ...]:
    return "*STEP", "*FREQUENCY", str(count), "*END STEP"


# ── joints ───────────────────────────────────────────────────────────────────────────────────────────


def _springs_lines(springs: Iterable[Spring], meshes: Mapping[str, PlacedMesh]) -> Iterator[str]:
    """A node, an equation and a spring to ground for every direction in which a joint resists."""
    number = max(mesh.following for mesh in meshes.values())
    for spring in springs:
        columns, displacement = _relative_displacement(spring, meshes)
        for stiffness, direction in _directions(spring.law):
            yield from ("*NODE", _node_line(number, spring.placement.translation), "*BOUNDARY", f"{number}, 2, 3")
            yield from _equation_lines(number, columns, direction @ displacement)
            yield from (f"*ELEMENT, TYPE=SPRING1, ELSET=S{number}", f"{number}, {number}")
            yield from (f"*SPRING, ELSET=S{number}", "1", _number(stiffness))
            number += 1


def _equation_lines(node: int, columns: IntArray, coefficients: FloatArray) -> Iterator[str]:
    """u_x of a node = sum of coefficients times translations; four terms a line."""
    terms = [f"{node}, 1, -1."]
    for column, value in zip(columns.tolist(), coefficients.tolist(), strict=True):
        if value != 0.0:
            terms.append(f"{column // 3 + 1}, {column % 3 + 1}, {_number(value)}")
    yield from ("*EQUATION", str(len(terms)))
    yield from (", ".join(terms[start : start + 4]) for start in range(0, len(terms), 4))


def _directions(law: JointCompliance) -> Iterator[tuple[float, FloatArray]]:
    """k and l (6,) of the springs that make up an elastic law, K = sum k l l^T; k in N/m: rotations act on an arm."""
    assert law.rigid_wrenches.shape[1] == 0, "rigid directions are no springs"
    along, about = np.trace(law.stiffness[:3, :3]), np.trace(law.stiffness[3:, 3:])
    arm = np.sqrt(about / along) if along > 0.0 and about > 0.0 else 1.0
    lengths = np.array([1.0, 1.0, 1.0, arm, arm, arm])
    values, vectors = np.linalg.eigh(law.stiffness / np.outer(lengths, lengths))
    for value, vector in zip(values.tolist(), vectors.T, strict=True):
        if value > 1e-9 * values[-1]:
            yield value, vector * lengths


def _relative_displacement(spring: Spring, meshes: Mapping[str, PlacedMesh]) -> Columns:
    """Motion of end B less that of end A, in the spring's axes."""
    into_spring = np.kron(np.eye(2), spring.placement.rotation.T)
    columns, motions = [], []
    for end, sign in zip(spring.between, (-1.0, 1.0), strict=True):
        body, _, node = end.partition(".")
        ties = _ties(meshes[body].ties, node, spring.interface) if body in meshes else []
        for tie in ties:
            its_columns, motion = _motion(meshes[body], tie, np.asarray(spring.placement.translation))
            columns.append(its_columns)
            motions.append(sign / len(ties) * into_spring @ motion)
    unique, place = np.unique(np.concatenate(columns), return_inverse=True)
    total = np.zeros((len(unique), 6))
    np.add.at(total, place, np.hstack(motions).T)
    return unique, total.T


def _ties(ties: Sequence[Tie], node: str, interface: str | None) -> list[Tie]:
    """The interface's own tie, else the joint's, else all ties of the joint, whose mean is taken."""
    named = {tie.node: tie for tie in ties}
    for name in (f"{node}.{interface}", node):
        if name in named:
            return [named[name]]
    return [tie for tie in ties if tie.node.startswith(f"{node}.")]


def _motion(mesh: PlacedMesh, tie: Tie, at: FloatArray) -> Columns:
    """(delta, eps) of a tie, taken at a point of the world.

    Of an averaged one: delta = sum w u / sum w at the centre, eps = J^-1 sum w r x u with J = sum w (r^2 - r r^T).
    """
    if tie.coupling == "rigid":
        return 3 * (mesh.rigid_node(tie) - 1) + np.arange(6), _carried(np.eye(6), at - tie.position)
    weights, points = tie.weights / tie.weights.sum(), mesh.points[tie.indices]
    centre = weights @ points
    moments = [weight * _cross(arm) for weight, arm in zip(weights, points - centre, strict=True)]
    inertia = -sum(moment @ _cross(arm) for moment, arm in zip(moments, points - centre, strict=True))
    motion = np.vstack([np.kron(weights, np.eye(3)), np.linalg.solve(inertia, np.hstack(moments))])
    columns = 3 * (mesh.first - 1 + tie.indices)[:, None] + np.arange(3)
    return columns.ravel(), _carried(motion, at - centre)


def _carried(motion: FloatArray, arm: FloatArray) -> FloatArray:
    """delta + eps x arm, eps."""
    return np.vstack([motion[:3] - _cross(arm) @ motion[3:], motion[3:]])


def _cross(v: FloatArray) -> FloatArray:
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


# ── text ─────────────────────────────────────────────────────────────────────────────────────────────


def _node_line(node: int, point: FloatArray) -> str:
    return f"{node}, " + ", ".join(map(_number, point))


def _number(value: float) -> str:
    """Thirteen digits: ccx reads twenty characters."""
    return f"{value:.12e}"


def _text(lines: Iterable[str]) -> str:
    return "\n".join(lines) + "\n"
