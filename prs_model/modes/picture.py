"""Mode shapes drawn on the parts' own surfaces, one panel a mode."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from errno import EISDIR
from math import ceil
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from ..arrays import FloatArray, IntArray
from ..errors import MissingExtraError, PrsError, short

if TYPE_CHECKING:
    from .modes import Modes


_FORMATS = (".png", ".svg", ".pdf")
_AMPLITUDE = 0.06  # largest displacement drawn, as a share of the machine's size
_GROUNDED_OPACITY = 0.15  # a frame around the machine must not hide it


def check_picture_file(path: Path) -> None:
    """Raise PrsError now if a picture could not be written to `path` later."""
    if path.suffix.lower() not in _FORMATS:
        raise PrsError(f"{path}: found a name ending in '{path.suffix}', expected one of {', '.join(_FORMATS)}")
    with _told(path):
        if path.is_dir():
            raise IsADirectoryError(EISDIR, "it is a folder")
        _temporary(path).unlink()
    _matplotlib()


def draw_modes(modes: Modes, path: Path, title: str = "") -> None:
    """Draw every mode of `modes` into one PNG, SVG or PDF file.

    Colour is the displacement relative to the largest of the mode, drawn enlarged over the shape at rest (grey);
    a part without a picture surface is drawn as lines between its nodes.
    The file appears only when it is complete. Raises PrsError or MissingExtraError.
    """
    check_picture_file(path)
    plt = _matplotlib()
    bodies = [_body_picture(modes, name) for name in modes.system.elements]
    points = np.vstack([body.points for body in bodies])
    low, high = points.min(axis=0), points.max(axis=0)
    count = modes.shapes.shape[1]
    columns = min(count, 4)
    figure = plt.Figure(figsize=(3.6 * columns, 4.4 * ceil(count / columns)), layout="constrained")
    for k, character in enumerate(modes.characters()):
        axes = figure.add_subplot(ceil(count / columns), columns, k + 1, projection="3d")
        _draw_mode(plt, axes, bodies, k, _AMPLITUDE * float(np.max(high - low)))
        _frame(axes, low, high)
        axes.set_title(f"mode {k + 1}: {modes.frequencies[k]:.1f} Hz\n{character.group} {character.motion}", fontsize=9)
    bar = figure.colorbar(plt.scale, ax=figure.axes, orientation="horizontal", shrink=0.3, aspect=40, pad=0.01)
    bar.set_label("displacement / largest displacement of the mode", fontsize=8)
    figure.suptitle(title)
    _write(figure, path)


@dataclass(frozen=True)
class _BodyPicture:
    """A body in the world: points (p, 3), triangles (t, 3) or lines (t, 2) between them, displacements (k, p, 3)."""

    points: FloatArray
    cells: IntArray
    displacements: FloatArray
    opacity: float


def _draw_mode(plt: SimpleNamespace, axes: Any, bodies: Sequence[_BodyPicture], mode: int, amplitude: float) -> None:
    """All bodies at rest, faint, and where the mode takes them; faces in one collection, so that depth is right."""
    largest = max(float(np.linalg.norm(body.displacements[mode], axis=1).max()) for body in bodies) or 1.0
    for corners in (2, 3):
        drawn = [body for body in bodies if body.cells.shape[1] == corners]
        if not drawn:
            continue
        rest = np.concatenate([body.points[body.cells] for body in drawn])
        moved = np.concatenate([body.displacements[mode][body.cells] for body in drawn]) / largest
        colours = plt.colours(np.linalg.norm(moved, axis=2).mean(axis=1))
        colours[:, 3] = np.concatenate([np.full(len(body.cells), body.opacity) for body in drawn])
        if corners == 2:
            axes.add_collection3d(plt.Lines(rest, colors=(0.5, 0.5, 0.5, 0.4), linewidths=0.6))
            axes.add_collection3d(plt.Lines(rest + amplitude * moved, colors=colours, linewidths=2.0))
        else:
            outline = plt.Faces(rest, facecolors=(0.0, 0.0, 0.0, 0.0), edgecolors=(0.5, 0.5, 0.5, 0.1), linewidths=0.2)
            axes.add_collection3d(outline)
            axes.add_collection3d(plt.Faces(rest + amplitude * moved, facecolors=colours, linewidths=0.0, shade=True))


def _body_picture(modes: Modes, name: str) -> _BodyPicture:
    element, placement = modes.system.elements[name], modes.system.placements[name]
    if element.surface is not None:
        surface = element.surface
        points, cells, recovery = surface.points, surface.triangles, surface.recovery.astype(float)
    else:
        points, cells, recovery = _star(element.positions, element.motions[:, :3])
    displacements = np.einsum("pin,nk->kpi", recovery, modes.body_shapes(name))
    rotation = placement.rotation
    opacity = _GROUNDED_OPACITY if element.grounded else 1.0
    return _BodyPicture(points @ rotation.T + placement.translation, cells, displacements @ rotation.T, opacity)


def _star(nodes: FloatArray, motions: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
    """Lines from every node to the middle of them all."""
    points = np.vstack([nodes, nodes.mean(axis=0)])
    recovery = np.concatenate([motions, motions.mean(axis=0, keepdims=True)])
    ring = np.arange(len(nodes))
    return points, np.column_stack([ring, np.full(len(ring), len(ring))]), recovery


def _frame(axes: Any, low: FloatArray, high: FloatArray) -> None:
    margin = 0.03 * float(np.max(high - low))
    for axis, a, b in zip("xyz", low - margin, high + margin, strict=True):
        getattr(axes, f"set_{axis}lim")(a, b)
        getattr(axes, f"set_{axis}label")(f"{axis} / m", fontsize=7)
    axes.tick_params(labelsize=6)
    axes.set_box_aspect(high - low + 2 * margin, zoom=0.88)
    axes.view_init(elev=18, azim=-60)


def _write(figure: Any, path: Path) -> None:
    with _told(path):
        complete = _temporary(path)
        try:
            figure.savefig(complete, dpi=130)
            complete.chmod(0o644)
            complete.replace(path)
        finally:
            complete.unlink(missing_ok=True)


def _temporary(path: Path) -> Path:
    """A new empty file beside `path`."""
    handle, name = tempfile.mkstemp(dir=path.parent, suffix=path.suffix.lower())
    os.close(handle)
    return Path(name)


@contextmanager
def _told(path: Path) -> Iterator[None]:
    """Whatever keeps a file from being written becomes a PrsError."""
    try:
        yield
    except OSError as error:
        expected = "expected a file name in a folder that exists and is writable"
        raise PrsError(f"{short(path)}: cannot be written ({error.strerror or error}); {expected}") from error


def _matplotlib() -> SimpleNamespace:
    try:
        from matplotlib import colormaps
        from matplotlib.cm import ScalarMappable
        from matplotlib.figure import Figure
        from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
    except ImportError as error:
        raise MissingExtraError("matplotlib", "plot", "drawing mode shapes") from error
    except ValueError as error:  # a setting of its own that it does not take, such as MPLBACKEND
        raise PrsError(f"matplotlib cannot be used: {error}") from error
    return SimpleNamespace(
        Figure=Figure,
        Faces=Poly3DCollection,
        Lines=Line3DCollection,
        scale=ScalarMappable(cmap="viridis"),
        colours=colormaps["viridis"],
    )
