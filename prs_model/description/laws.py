"""Stiffnesses and compliances: complete, physical, and nothing on a free axis."""

from __future__ import annotations

import numpy as np

from .problems import Place, Problems, listed
from .schema import AXES, DiagonalCompliance, DiagonalStiffness, ElasticLaw, Stage, StiffnessLaw
from .urdf import UrdfJoint

LAWS = ("rigid", "stiffness", "compliance")


def check_one_of(problems: Problems, place: Place, section: object, ways: tuple[str, ...]) -> bool:
    """Whether exactly one of the entries is given; a problem if not."""
    given = [way for way in ways if getattr(section, way) not in (None, False, ())]
    if len(given) == 1:
        return True
    found = " and ".join(given) or "none of them"
    advice = "keep one" if given else "add one"
    problems.add(place, f"found {found}, expected exactly one of {listed(ways)}; {advice}")
    return False


def check_law(problems: Problems, place: Place, law: ElasticLaw, joint: UrdfJoint | None) -> None:
    """Check the axes or the matrix of one law against the axis along which `joint` moves (None: none)."""
    for kind in ("stiffness", "compliance"):
        value = getattr(law, kind)
        if isinstance(value, DiagonalStiffness | DiagonalCompliance):
            _check_axes(problems, (*place, kind), value, joint)
        elif value is not None:
            _check_matrix(problems, (*place, kind), np.array(value, dtype=float), joint)


def _check_axes(
    problems: Problems, place: Place, law: DiagonalStiffness | DiagonalCompliance, joint: UrdfJoint | None
) -> None:
    free = joint.free_axis if joint is not None else None
    how = "'rigid'" if isinstance(law, DiagonalStiffness) else "0 for rigid"
    for axis in AXES:
        value = getattr(law, axis)
        if axis == free and value is not None and joint is not None:
            problems.add((*place, axis), f"found a value, expected none; {_freedom(joint)}")
        elif axis != free and value is None:
            problems.add(
                (*place, axis), f"found nothing, expected a value on every constrained axis; give a number or {how}"
            )


def _check_matrix(problems: Problems, place: Place, matrix: np.ndarray, joint: UrdfJoint | None) -> None:
    scaled = _scaled(matrix)
    row, column = divmod(int(np.argmax(np.abs(scaled - scaled.T))), 6)
    if abs(scaled[row, column] - scaled[column, row]) > 1e-6:
        message = f"found different entries [{row}][{column}] and [{column}][{row}], expected a symmetric matrix"
        problems.add(place, message)
        return
    free = joint.free_axis if joint is not None else None
    if free is not None and joint is not None and matrix[AXES.index(free)].any():
        index = AXES.index(free)
        problems.add(place, f"found entries in row {index} ({free}), expected zeros; {_freedom(joint)}")
    elif np.linalg.eigvalsh(scaled)[0] < -1e-9:
        problems.add(
            place, "found a matrix with a negative eigenvalue, expected a positive semi-definite one; check signs"
        )


def _scaled(matrix: np.ndarray) -> np.ndarray:
    """With a unit diagonal, so that metres and radians do not matter."""
    scale = np.sqrt(np.abs(np.diag(matrix)))
    scale[scale == 0.0] = 1.0
    return np.asarray(matrix / np.outer(scale, scale))


def _freedom(joint: UrdfJoint) -> str:
    motion = "about" if joint.is_rotary else "along"
    return f"'{joint.name}' is free {motion} {joint.free_axis}; use 'drive' for what an actuator holds there"


def leaves_free(stage: Stage) -> bool:
    """Whether some direction meets no stiffness at all in a stage, or in each of its interfaces."""
    return all(_has_zero(law.stiffness) for law in stage.interfaces or (stage,))


def _has_zero(stiffness: StiffnessLaw | None) -> bool:
    if stiffness is None:
        return False
    if isinstance(stiffness, DiagonalStiffness):
        return any(getattr(stiffness, axis) == 0 for axis in AXES)
    return bool(np.linalg.eigvalsh(_scaled(np.array(stiffness, dtype=float)))[0] < 1e-9)
