"""Mode shapes drawn on the parts' own surfaces, one panel a mode."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil
from pathlib import Path
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np
import pinocchio as pin

from ..arrays import FloatArray, IntArray
from ..errors import PrsError
from .figure_file import check_writable, matplotlib_told, write_figure

if TYPE_CHECKING:
    from .modes import Modes


_FORMATS = (".png", ".svg", ".pdf")
_AMPLITUDE = 0.08  # largest displacement drawn, as a share of the machine's size
_GROUNDED_OPACITY = 0.12  # a frame around the machine must not hide it
_STILL_OPACITY = 0.25


def check_picture_file(path: Path) -> None:
    """Raise PrsError now if a picture could not be written to `path` later."""
    if path.suffix.lower() not in _FORMATS:
        raise PrsError(f"{path}: found a name ending in '{path.suffix}', expected one of {', '.join(_FORMATS)}")
    check_writable(path)
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
    figure = plt.Figure(figsize=(3.4 * columns, 3.9 * ceil(count / columns) + 0.9), layout="constrained")
    for k, character in enumerate(modes.characters()):
        axes = figure.add_subplot(ceil(count / columns), columns, k + 1, projection="3d")
        _draw_mode(plt, axes, bodies, k, _AMPLITUDE * float(np.max(high - low)))
        _draw_axes(axes, modes.system.output_placement, 0.12 * float(np.max(high - low)))
        _draw_scale(axes, low, high)
        _set_view(axes, low, high)
        words = f"{character.group} {character.motion}; tool {character.output}"
        axes.set_title(f"mode {k + 1}: {modes.frequencies[k]:.1f} Hz\n{words}", fontsize=9, parse_math=False)
    bar = figure.colorbar(plt.scale, ax=figure.axes, orientation="horizontal", shrink=0.3, aspect=40, pad=0.01)
    bar.set_label("displacement / largest displacement of the mode", fontsize=8)
    figure.suptitle(title, parse_math=False)
    write_figure(figure, path)


@dataclass(frozen=True)
class _BodyPicture:
    """A body in the world: points (p, 3), triangles (t, 3) or lines (t, 2) between them, displacements (k, p, 3)."""

    points: FloatArray
    cells: IntArray
    displacements: FloatArray
    is_grounded: bool

    def amplitude(self, mode: int) -> float:
        return float(np.linalg.norm(self.displacements[mode], axis=1).max())

    def opacities(self, share: float) -> FloatArray:
        """(t,) of a body that moves by `share` of the mode's largest displacement: what stands still hides nothing."""
        moving = _STILL_OPACITY + (1.0 - _STILL_OPACITY) * min(1.0, 3.0 * share)
        return np.full(len(self.cells), _GROUNDED_OPACITY if self.is_grounded else moving)


def _draw_mode(plt: SimpleNamespace, axes: Any, bodies: Sequence[_BodyPicture], mode: int, amplitude: float) -> None:
    """All bodies at rest, faint, and where the mode takes them; faces in one collection, so that depth is right."""
    largest = max(body.amplitude(mode) for body in bodies) or 1.0
    for corners in (2, 3):
        drawn = [body for body in bodies if body.cells.shape[1] == corners]
        if not drawn:
            continue
        rest = np.concatenate([body.points[body.cells] for body in drawn])
        moved = np.concatenate([body.displacements[mode][body.cells] for body in drawn]) / largest
        colours = plt.colours(np.linalg.norm(moved, axis=2).max(axis=1))
        if corners == 2:
            axes.add_collection3d(plt.Lines(rest, colors=(0.5, 0.5, 0.5, 0.5), linewidths=0.8))
            axes.add_collection3d(plt.Lines(rest + amplitude * moved, colors=colours, linewidths=2.5))
        else:
            colours[:, 3] = np.concatenate([body.opacities(body.amplitude(mode) / largest) for body in drawn])
            axes.add_collection3d(plt.Faces(rest, facecolors=(0.5, 0.5, 0.5, 0.06), linewidths=0.0))
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
    world = points @ rotation.T + placement.translation
    return _BodyPicture(world, cells, displacements @ rotation.T, element.grounded)


def _star(nodes: FloatArray, motions: FloatArray) -> tuple[FloatArray, IntArray, FloatArray]:
    """Lines from every node to the middle of them all."""
    points = np.vstack([nodes, nodes.mean(axis=0)])
    recovery = np.concatenate([motions, motions.mean(axis=0, keepdims=True)])
    ring = np.arange(len(nodes))
    return points, np.column_stack([ring, np.full(len(ring), len(ring))]), recovery


def _draw_axes(axes: Any, place: pin.SE3, length: float) -> None:
    """The output frame's u, v, w at the end-reference point."""
    for name, direction in zip("uvw", place.rotation.T, strict=True):
        tip = place.translation + length * direction
        axes.plot(*np.column_stack([place.translation, tip]), color="black", linewidth=0.8)
        axes.text(*(place.translation + 1.25 * length * direction), name, fontsize=8, ha="center", va="center")


def _draw_scale(axes: Any, low: FloatArray, high: FloatArray) -> None:
    """A bar of a round length along z, beside the machine."""
    length = 10.0 ** np.floor(np.log10(np.max(high - low) / 2.0))
    axes.plot([low[0]] * 2, [low[1]] * 2, [low[2], low[2] + length], color="black", linewidth=1.5)
    axes.text(low[0], low[1], low[2] + length / 2.0, f" {1e3 * length:g} mm", fontsize=7, va="center")


def _set_view(axes: Any, low: FloatArray, high: FloatArray) -> None:
    size = np.maximum(high - low, 0.05 * np.max(high - low))
    for axis, middle, half in zip("xyz", (low + high) / 2.0, size / 2.0, strict=True):
        getattr(axes, f"set_{axis}lim")(middle - half, middle + half)
    axes.set_axis_off()
    axes.set_box_aspect(size, zoom=1.12)
    axes.view_init(elev=20, azim=-35)


def _matplotlib() -> SimpleNamespace:
    with matplotlib_told("drawing mode shapes"):
        from matplotlib import colormaps
        from matplotlib.cm import ScalarMappable
        from matplotlib.figure import Figure
        from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection
    return SimpleNamespace(
        Figure=Figure,
        Faces=Poly3DCollection,
        Lines=Line3DCollection,
        scale=ScalarMappable(cmap="viridis"),
        colours=colormaps["viridis"],
    )
