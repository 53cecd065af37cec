"""Redraws the pictures of head_3prs in this folder from reports on it and a map: python docs/pictures/redraw.py"""

from pathlib import Path
from shutil import copyfile
from tempfile import TemporaryDirectory

import numpy as np
from PIL import Image

import prs_model as prs
from prs_model.sweep.files import save

HERE = Path(__file__).parent
SETTINGS = {"head_3prs": "joint-loaded", "head_3prs_paper": "craig-bampton"}
FIGURES = {
    "frf": "figure_11",
    "flexibility": "figure_15",
    "kinetic_energy_by_limb": "figure_16",
    "strain_energy_by_limb": "figure_17",
}
STEP = 255 / 20


def redraw(prefix: str, method: str) -> None:
    """Figures 11, 15, 16 and 17 of the paper and the mode shapes, by one reduction method."""
    machine = prs.load_machine("head_3prs").replace({"reduction.method": method})
    with TemporaryDirectory() as folder:
        prs.write_report(machine, folder)
        drawn = Path(folder, "pose_1")
        for name, figure in FIGURES.items():
            copyfile(drawn / f"{name}.png", HERE / f"{prefix}_{figure}.png")
        lighten(drawn / "mode_shapes.png", HERE / f"{prefix}_mode_shapes.png")


def redraw_map() -> None:
    """Figure 14 of the paper: six frequencies over nutation and precession."""
    nutation, precession = np.radians(np.linspace(0.0, 30.0, 100)), np.radians(np.linspace(0.0, 360.0, 361))
    data = prs.load_machine("head_3prs").sweep(nutation=nutation, precession=precession, z=1.275)
    with TemporaryDirectory() as folder:
        drawn = Path(folder, "map.png")
        save(data, drawn)
        Image.open(drawn).convert("RGB").quantize(64).save(HERE / "head_3prs_map.png", optimize=True)


def lighten(source: Path, target: Path) -> None:
    """The same picture with fewer shades of each colour."""
    shades = [round(round(value / STEP) * STEP) for value in range(256)]
    Image.open(source).convert("RGB").point(3 * shades).save(target, optimize=True)


if __name__ == "__main__":
    for prefix, method in SETTINGS.items():
        redraw(prefix, method)
    redraw_map()
