"""Mode shapes drawn on the parts' own surfaces, one panel a mode."""

from __future__ import annotations

import os
import tempfile
from math import ceil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..errors import MissingExtraError, PrsError

if TYPE_CHECKING:
    from .modes import Modes


_FORMATS = (".png", ".svg", ".pdf")
_AMPLITUDE = 0.06  # largest displacement drawn, as a share of the machine's size


def check_picture_file(path: Path) -> None:
    """Raise PrsError now if a picture could not be written to `path` later."""
    if path.suffix.lower() not in _FORMATS:
        raise PrsError(f"{path}: found a name ending in '{path.suffix}', expected one of {', '.join(_FORMATS)}")
    if path.is_dir() or not path.parent.is_dir() or not os.access(path.parent, os.W_OK):
        raise PrsError(f"{path}: cannot be written; expected a file name in a folder that exists and is writable")
    _matplotlib()


def draw_modes(modes: Modes, path: Path, title: str = "") -> None:
    """Draw every mode of `modes` into one PNG, SVG or PDF file.

    Colour is the displacement relative to the largest of the mode, drawn enlarged over the shape at rest (grey).
    The file appears only when it is complete. Raises PrsError or MissingExtraError.
    """
    check_picture_file(path)
    figure_class, poly_class, map_colours, colour_map = _matplotlib()
    bodies = [_BodyPicture(modes, name) for name in modes.system.elements]
    points = np.vstack([body.points for body in bodies])
    low, high = points.min(axis=0), points.max(axis=0)
    size = float(np.max(high - low))
    count = modes.shapes.shape[1]
    columns = min(count, 4)
    figure = figure_class(figsize=(3.6 * columns, 4.4 * ceil(count / columns)), layout="constrained")
    for k, character in enumerate(modes.characters()):
        axes = figure.add_subplot(ceil(count / columns), columns, k + 1, projection="3d")
        largest = max(float(np.linalg.norm(body.displacements[k], axis=1).max()) for body in bodies) or 1.0
        for body in bodies:
            moved = body.points + body.displacements[k] * (_AMPLITUDE * size / largest)
            amplitude = np.linalg.norm(body.displacements[k], axis=1) / largest
            axes.add_collection3d(
                poly_class(
                    body.points[body.triangles], facecolor="none", edgecolor=(0.5, 0.5, 0.5, 0.08), linewidth=0.2
                )
            )
            faces = colour_map(amplitude[body.triangles].mean(axis=1))
            axes.add_collection3d(poly_class(moved[body.triangles], facecolor=faces, edgecolor="none", shade=True))
        _frame(axes, low, high)
        axes.set_title(f"mode {k + 1}: {modes.frequencies[k]:.1f} Hz\n{character.group} {character.motion}", fontsize=9)
    bar = figure.colorbar(map_colours, ax=figure.axes, orientation="horizontal", shrink=0.3, aspect=40, pad=0.01)
    bar.set_label("displacement / largest displacement of the mode", fontsize=8)
    figure.suptitle(title)
    _write(figure, path)


class _BodyPicture:
    """A body's picture surface in the world, and its displacements (p, 3) in each mode."""

    def __init__(self, modes: Modes, name: str):
        element, placement = modes.system.elements[name], modes.system.placements[name]
        if element.surface is not None:
            local, self.triangles = element.surface.points, element.surface.triangles
            recovery = np.asarray(element.surface.recovery, dtype=float)
        else:
            local, self.triangles = _star(element.positions)
            recovery = element.motions[:, :3, :]
            if len(local) > len(element.positions):
                recovery = np.concatenate([recovery, recovery.mean(axis=0, keepdims=True)])
        rotation = placement.rotation
        self.points = local @ rotation.T + placement.translation
        moved = np.einsum("pin,nk->kpi", recovery, modes.body_shapes(name))
        self.displacements = moved @ rotation.T


def _star(nodes: FloatArray) -> tuple[FloatArray, IntArray]:
    """Triangles between a body's nodes, or lines from one node, where there is no surface to draw."""
    points = np.vstack([nodes, nodes.mean(axis=0)]) if len(nodes) > 2 else nodes
    last, ring = len(points) - 1, np.arange(len(nodes))
    return points, np.column_stack([ring, np.roll(ring, -1), np.full(len(ring), last)])


def _frame(axes: Any, low: FloatArray, high: FloatArray) -> None:
    margin = 0.03 * float(np.max(high - low))
    for axis, a, b in zip("xyz", low - margin, high + margin, strict=True):
        getattr(axes, f"set_{axis}lim")(a, b)
        getattr(axes, f"set_{axis}label")(f"{axis} / m", fontsize=7)
    axes.tick_params(labelsize=6)
    axes.set_box_aspect(high - low + 2 * margin)
    axes.view_init(elev=18, azim=-60)


def _write(figure: Any, path: Path) -> None:
    handle, name = tempfile.mkstemp(dir=path.parent, suffix=path.suffix.lower())
    os.close(handle)
    try:
        figure.savefig(name, dpi=130)
        os.chmod(name, 0o644)
        os.replace(name, path)
    finally:
        Path(name).unlink(missing_ok=True)


def _matplotlib() -> tuple[Any, Any, Any, Any]:
    try:
        from matplotlib import colormaps
        from matplotlib.cm import ScalarMappable
        from matplotlib.figure import Figure
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection
    except ImportError as error:
        raise MissingExtraError("matplotlib", "plot", "drawing mode shapes") from error
    return Figure, Poly3DCollection, ScalarMappable(cmap="viridis"), colormaps["viridis"]
