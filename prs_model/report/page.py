"""The page: one file that needs nothing else, filled from a template."""

from __future__ import annotations

import base64
import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..errors import MissingExtraError
from ..readable import figure, readable, readable_range
from ..response.quantity import DIRECTIONS, unit

if TYPE_CHECKING:
    from ..machine import Machine
    from .card import Joint, Part
    from .figures import Figure
    from .scene import Scene, Shape
    from .sources import Entry
    from .study import Study

_ASSETS = Path(__file__).parent / "assets"
_SCRIPTS = ("viewer.js", "chart.js", "page.js")
_UNIT = 32767  # of displacements as whole numbers


@dataclass(frozen=True, eq=False)
class Pose:
    """What the page shows of one pose: its numbers, its figures and the files beside the page."""

    study: Study
    scene: Scene
    figures: tuple[Figure, ...]
    files: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class Content:
    """All that the page shows."""

    machine: Machine
    poses: tuple[Pose, ...]
    parts: tuple[Part, ...]
    joints: tuple[Joint, ...]
    entries: tuple[Entry, ...]
    mass: float
    warnings: tuple[str, ...]
    published: dict[str, tuple[float, ...]]
    command: str
    map: Figure | None = None
    map_files: tuple[str, ...] = ()


def page(content: Content, folder: Path) -> str:
    """The page's text; figures are read from the folders of the poses in `folder`. Raises MissingExtraError."""
    from .. import __version__

    template = environment().get_template("page.html.jinja")
    return str(
        template.render(
            content=content,
            machine=content.machine,
            file=content.machine.description.file,
            version=__version__,
            style=(_ASSETS / "style.css").read_text(encoding="utf-8"),
            scripts=[(_ASSETS / name).read_text(encoding="utf-8") for name in _SCRIPTS],
            data=_script_safe(json.dumps(_data(content.poses), separators=(",", ":"))),
            image=lambda pose, name: _image(folder / pose.study.folder / name),
            map_image=None if content.map is None else _image(folder / f"{content.map.name}.png"),
            workspace=_workspace(content.machine),
            directions=[(each, unit(each, each)) for each in DIRECTIONS],
        )
    )


@cache
def environment() -> Any:
    """Jinja's environment over the templates. Raises MissingExtraError without jinja2."""
    try:
        from jinja2 import Environment, FileSystemLoader, StrictUndefined
    except ImportError as error:
        raise MissingExtraError("jinja2", "report", "making a report") from error
    environment = Environment(
        loader=FileSystemLoader(_ASSETS),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["figure"] = figure
    environment.filters["percent"] = lambda share: f"{100.0 * share:.1f}"
    return environment


def _data(poses: Sequence[Pose]) -> dict[str, Any]:
    """What the scripts need. Poses of one machine share their triangles, as far as these are the same."""
    meshes: list[dict[str, Any]] = []
    listed = []
    for pose in poses:
        mesh = _mesh(pose.scene)
        if mesh not in meshes:
            meshes.append(mesh)
        listed.append({**_pose(pose), "scene": _scene(pose.scene), "mesh": meshes.index(mesh)})
    return {"meshes": meshes, "poses": listed}


def _pose(pose: Pose) -> dict[str, Any]:
    """Frequencies, labels and responses, to the digits that a screen shows."""
    modes, response = pose.study.modes, pose.study.response
    curves = {} if response is None else {axis: _complex(response.curve(axis)) for axis in "uvw"}
    return {
        "frequencies": [round(float(f), 4) for f in modes.frequencies],
        "labels": [f"{each.group} {each.motion}" for each in modes.characters()],
        "frf": None
        if response is None
        else {"hz": [round(float(f), 4) for f in response.frequencies], "curves": curves},
    }


def _mesh(scene: Scene) -> dict[str, Any]:
    """How the points of all bodies in one list are joined, the grounded bodies last."""
    shapes = _ordered(scene)
    kinds = list(dict.fromkeys(shape.kind for shape in shapes))
    starts = np.cumsum([0, *(len(shape.points) for shape in shapes)])[:-1]
    free = [shape for shape in shapes if not shape.grounded]
    return {
        "kind": _text(np.concatenate([np.full(len(s.points), kinds.index(s.kind)) for s in shapes]).astype("u1")),
        "triangles": _text(_numbered([shape.triangles for shape in shapes], starts)),
        "edges": _text(_numbered([shape.edges for shape in shapes], starts)),
        "freeTriangles": sum(shape.triangles.size for shape in free),
        "freeEdges": sum(shape.edges.size for shape in free),
    }


def _scene(scene: Scene) -> dict[str, Any]:
    """Where the points are; displacements (k, p, 3) as whole numbers, 32767 the largest."""
    shapes = _ordered(scene)
    moved = np.concatenate([shape.displacements for shape in shapes], axis=1)
    return {
        "points": _text(np.vstack([shape.points for shape in shapes]).astype("<f4")),
        "moved": _text(np.round(_UNIT * np.clip(moved, -1.0, 1.0)).astype("<i2")),
        "centre": scene.centre.tolist(),
        "size": scene.size,
        "output": scene.output.tolist(),
        "axes": scene.axes.T.tolist(),
    }


def _ordered(scene: Scene) -> list[Shape]:
    return sorted(scene.shapes, key=lambda shape: shape.grounded)


def _numbered(cells: Sequence[NDArray[Any]], starts: NDArray[Any]) -> NDArray[Any]:
    return np.concatenate([(each + start).ravel() for each, start in zip(cells, starts, strict=True)]).astype("<u4")


def _complex(curve: NDArray[np.complex128]) -> list[list[float]]:
    return [[float(f"{x:.5g}") for x in part] for part in (curve.real, curve.imag)]


def _text(array: NDArray[Any]) -> str:
    return base64.b64encode(np.ascontiguousarray(array).tobytes()).decode()


def _image(path: Path) -> str:
    """A figure in the page itself."""
    kind = {".svg": "image/svg+xml", ".png": "image/png"}[path.suffix]
    return f"data:{kind};base64,{base64.b64encode(path.read_bytes()).decode()}"


def _script_safe(text: str) -> str:
    """JSON that cannot end the script element it stands in."""
    return text.replace("<", "\\u003c")


def _workspace(machine: Machine) -> list[tuple[str, str, str]]:
    """Pose coordinates: name, reference, bounds."""
    kinds = machine.kinematics.task.coordinates
    return [
        (name, readable(machine.reference_pose[name], kind), readable_range(*machine.workspace[name], kind))
        for name, kind in kinds.items()
    ]
