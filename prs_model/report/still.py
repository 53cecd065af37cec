"""Mode shapes as a still picture, for paper and for browsers without WebGL: what is nearer is painted later."""

from __future__ import annotations

from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import FloatArray
from ..modes.drawn import AMPLITUDE
from ..modes.figure_file import matplotlib_told, write_figure
from .figures import report_figure
from .scene import Scene
from .study import Study

_YAW, _PITCH = np.radians(-35.0), np.radians(20.0)
_AXIS = 0.08  # length of u, v and w drawn, over the machine's size
_FINE = 0.06  # longest side of what is painted, likewise: large faces are in front of some and behind others
_COLUMNS = 4  # at most
_WIDTH, _TITLE, _BAR = 2.6, 0.45, 0.5  # inches: of a panel, above it, and below the last one
_LIGHT = np.array([0.3, 0.5, 0.81])


def draw_still(study: Study, scene: Scene, path: Path) -> None:
    """Draw every mode of a pose, displaced, coloured by displacement; what is grounded can be seen through.

    For PNG: as vectors, so many triangles take tens of megabytes.
    """
    count = len(study.modes.frequencies)
    rows = ceil(count / _COLUMNS)
    columns = ceil(count / rows)
    panel = _WIDTH * _proportion(scene)
    width, height = _WIDTH * columns, (panel + _TITLE) * rows + _BAR
    figure = report_figure()(figsize=(width, height))
    figure.subplots_adjust(0.0, _BAR / height, 1.0, 1.0 - _TITLE / height, wspace=0.02, hspace=_TITLE / panel)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes in panels:
        axes.set_axis_off()
    for mode, (axes, character) in enumerate(zip(panels, study.characters, strict=False)):
        _draw(axes, scene, mode)
        title = f"{mode + 1}: {study.modes.frequencies[mode]:.1f} Hz\n{character.group} {character.motion}"
        axes.set_title(title, fontsize=8)
    _draw_scale(figure, width, height)
    write_figure(figure, path)


def _draw(axes: Any, scene: Scene, mode: int) -> None:
    colours_of, collection = _matplotlib()
    turn, faces, colours = _camera(), [], []
    for shape in scene.shapes:
        moved = shape.displacements[mode]
        places = (shape.points + AMPLITUDE * scene.size * moved - scene.centre) @ turn.T
        shown = np.concatenate([places, moved], axis=1)[shape.triangles]
        corners, moves = np.split(shown if shape.grounded else _split(shown, _FINE * scene.size), 2, axis=2)
        colour = colours_of(np.linalg.norm(moves.mean(axis=1), axis=1))
        colour[:, :3] *= _shade(corners)[:, None]
        colour[:, 3] = 0.10 if shape.grounded else 1.0
        faces.append(corners)
        colours.append(colour)
    corners, colour = np.concatenate(faces), np.concatenate(colours)
    order = np.argsort(corners[:, :, 2].mean(axis=1))
    corners, colour = corners[order][:, :, :2], colour[order]
    seams = np.where(colour[:, 3] < 1.0, 0.0, 0.4)  # without them, what is behind shines through between faces
    axes.add_collection(collection(corners, facecolors=colour, edgecolors=colour, linewidths=seams))
    _draw_axes(axes, scene, turn)
    axes.set_aspect("equal")
    axes.autoscale_view()


def _split(triangles: FloatArray, longest: float) -> FloatArray:
    """Triangles (t, 3, 3 + m) of places and whatever belongs to them, cut into four until no side is longer."""
    sides = np.linalg.norm((np.roll(triangles, -1, axis=1) - triangles)[:, :, :3], axis=2).max(axis=1, initial=0.0)
    large = sides > longest
    if not large.any():
        return triangles
    cut = triangles[large]
    middles = 0.5 * (cut + np.roll(cut, -1, axis=1))
    ends = [np.stack([cut[:, k], middles[:, k], middles[:, k - 1]], axis=1) for k in range(3)]
    return np.concatenate([triangles[~large], _split(np.concatenate([*ends, middles]), longest)])


def _draw_axes(axes: Any, scene: Scene, turn: FloatArray) -> None:
    """u, v, w at the end-reference point at rest."""
    origin = turn @ (scene.output - scene.centre)
    for name, direction in zip("uvw", scene.axes.T, strict=True):
        tip, label = (origin + share * _AXIS * scene.size * (turn @ direction) for share in (1.0, 1.3))
        axes.plot(*zip(origin[:2], tip[:2], strict=True), color="black", linewidth=0.8)
        axes.text(*label[:2], name, fontsize=7, ha="center", va="center")


def _draw_scale(figure: Any, width: float, height: float) -> None:
    """What the colours mean, below the panels of a figure of so many inches."""
    axes = figure.add_axes((0.5 - 1.0 / width, 0.32 / height, 2.0 / width, 0.1 / height))
    axes.imshow(np.linspace(0.0, 1.0, 256)[None], cmap="viridis", aspect="auto", extent=(0.0, 1.0, 0.0, 1.0))
    axes.set(yticks=(), xticks=(0.0, 0.5, 1.0))
    axes.tick_params(labelsize=7, length=2, pad=1)
    axes.set_xlabel("displacement / largest displacement of the mode", fontsize=7, labelpad=1)


def _proportion(scene: Scene) -> float:
    """Height over width of the machine as it is seen, at rest."""
    seen = np.ptp(np.vstack([shape.points for shape in scene.shapes]) @ _camera().T, axis=0)
    return float(np.clip(seen[1] / max(seen[0], 1e-300), 0.4, 1.4))


def _camera() -> FloatArray:
    """(3, 3): rows are right, up, and toward the eye."""
    toward = np.array([np.cos(_PITCH) * np.cos(_YAW), np.cos(_PITCH) * np.sin(_YAW), np.sin(_PITCH)])
    right = np.array([-np.sin(_YAW), np.cos(_YAW), 0.0])
    return np.array([right, np.cross(toward, right), toward])


def _shade(corners: FloatArray) -> FloatArray:
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.maximum(np.linalg.norm(normals, axis=1), 1e-300)
    return np.asarray(0.45 + 0.55 * np.abs(normals @ _LIGHT) / size)


def _matplotlib() -> tuple[Any, Any]:
    with matplotlib_told("drawing a report", "report"):
        from matplotlib import colormaps
        from matplotlib.collections import PolyCollection
    return colormaps["viridis"], PolyCollection
