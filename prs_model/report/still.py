"""Mode shapes as a still picture, for paper and for browsers without WebGL: what is nearer is painted later."""

from __future__ import annotations

from math import ceil
from pathlib import Path
from typing import Any

import numpy as np

from ..arrays import FloatArray
from ..errors import MissingExtraError
from ..modes.figure_file import write_figure
from ..response.picture import matplotlib_figure
from .scene import Scene
from .study import Study

_YAW, _PITCH = np.radians(-55.0), np.radians(20.0)
_AMPLITUDE = 0.06  # of the machine's size
_LIGHT = np.array([0.3, 0.5, 0.81])


def draw_still(study: Study, scene: Scene, path: Path) -> None:
    """Draw every mode of a pose, displaced, coloured by displacement; what is grounded can be seen through.

    For PNG: as vectors, so many triangles take tens of megabytes.
    """
    count = len(study.modes.frequencies)
    columns = min(count, 4)
    rows = ceil(count / columns)
    figure = matplotlib_figure()(figsize=(2.6 * columns, 3.1 * rows))
    figure.subplots_adjust(left=0.0, right=1.0, bottom=0.01, top=1.0 - 0.14 / rows, wspace=0.02, hspace=0.18)
    panels = figure.subplots(rows, columns, squeeze=False).ravel()
    for axes in panels:
        axes.set_axis_off()
    for mode, (axes, character) in enumerate(zip(panels, study.modes.characters(), strict=False)):
        _draw(axes, scene, mode)
        title = f"{mode + 1}: {study.modes.frequencies[mode]:.1f} Hz\n{character.group} {character.motion}"
        axes.set_title(title, fontsize=8)
    write_figure(figure, path)


def _draw(axes: Any, scene: Scene, mode: int) -> None:
    colours_of, collection = _matplotlib()
    turn, faces, colours = _camera(), [], []
    for shape in scene.shapes:
        moved = shape.displacements[mode]
        corners = ((shape.points + _AMPLITUDE * scene.size * moved - scene.centre) @ turn.T)[shape.triangles]
        colour = colours_of(np.linalg.norm(moved, axis=1)[shape.triangles].mean(axis=1))
        colour[:, :3] *= _shade(corners)[:, None]
        colour[:, 3] = 0.10 if shape.grounded else 1.0
        faces.append(corners)
        colours.append(colour)
    corners, colour = np.concatenate(faces), np.concatenate(colours)
    order = np.argsort(corners[:, :, 2].mean(axis=1))
    axes.add_collection(
        collection(corners[order][:, :, :2], facecolors=colour[order], linewidths=0.0, antialiased=False)
    )
    axes.set_aspect("equal")
    axes.autoscale_view()


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
    try:
        from matplotlib import colormaps
        from matplotlib.collections import PolyCollection
    except ImportError as error:
        raise MissingExtraError("matplotlib", "report", "drawing a report") from error
    return colormaps["viridis"], PolyCollection
