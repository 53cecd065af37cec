"""Solved poses kept on disk, found again by everything that decides them."""

from __future__ import annotations

import json
import logging
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from .. import plugins
from ..arrays import FloatArray
from ..errors import PartFileError
from ..kinematics import Configuration
from ..reduction.recipe import file_hash, fingerprint
from ..reduction.request import asked
from ..reduction.stations import SAME
from ..reduction.storage import load_super_element, save, whole
from ..reduction.store import files_hash
from ..reduction.super_element import SuperElement
from .stock import Stock

VERSION = 1  # raised when the complete order changes its results
FIGURES = "modes.json"

logger = logging.getLogger("prs_model")


@dataclass(frozen=True, eq=False)
class Solved:
    """The modes at one pose: each part on its shapes in them; residuals (c,), number of DOFs, iterations, seconds."""

    elements: Mapping[str, SuperElement]
    residuals: FloatArray
    size: int
    iterations: int
    seconds: float


@dataclass(frozen=True)
class Kept:
    """A folder of its own for one pose: a file for each body, and the figures, which are written last.

    Surfaces come back in half precision, as those of all stored elements.
    """

    folder: Path
    recipe: str

    def find(self) -> Solved | None:
        """What is kept; None, said in the log where there is something else, or something damaged."""
        try:
            figures = json.loads((self.folder / FIGURES).read_text())
            if figures["recipe"] != self.recipe:
                raise ValueError("it holds another recipe than its name says")
            elements = {name: load_super_element(self.folder / f"{name}.npz") for name in figures["bodies"]}
            residuals = np.array(figures["residuals"], dtype=float)
            return Solved(elements, residuals, figures["size"], figures["iterations"], figures["seconds"])
        except FileNotFoundError:
            return None
        except (OSError, ValueError, TypeError, KeyError, PartFileError) as error:
            logger.warning("%s: not used, and made anew: %s", self.folder, error)
            return None

    def keep(self, solved: Solved) -> None:
        """Write; where that cannot be done the log says so."""
        figures = {
            "recipe": self.recipe,
            "bodies": list(solved.elements),
            "residuals": solved.residuals.tolist(),
            "size": solved.size,
            "iterations": solved.iterations,
            "seconds": solved.seconds,
        }
        try:
            for name, element in solved.elements.items():
                save(element, self.folder / f"{name}.npz")
            with whole(self.folder / FIGURES) as file:
                file.write(json.dumps(figures).encode())
        except (OSError, PartFileError) as error:
            logger.warning("%s: not kept: %s", self.folder, error)


def kept(folder: Path, stock: Stock, where: Configuration, count: int) -> Kept:
    """Where the `count` lowest modes in a configuration are kept. Raises what asking for a part raises."""
    description = stock.description
    parts = {kind: name for name, kind in stock.kinds.items()}
    content = {
        "version": VERSION,
        "count": count,
        "parts": {name: [kind.recipe, _files(name, stock)] for kind, name in parts.items()},
        "bodies": {name: [parts[kind], stock.bodies[name].frame] for name, kind in stock.kinds.items()},
        "joints": {name: joint.model_dump(mode="json") for name, joint in description.joints.items()},
        "travel": {name: body.model_dump(mode="json")["interfaces"] for name, body in stock.bodies.items()},
        "output": description.file.output.model_dump(mode="json"),
        "urdf": file_hash(description.urdf_path),
        "at": {name: round(value, SAME) for name, value in where.joint_values.items()},
    }
    text = json.dumps(content, sort_keys=True, separators=(",", ":"))
    return Kept(folder / f"complete-{fingerprint(text)}", text)


def _files(name: str, stock: Stock) -> str | None:
    """The content of the files that a body is read from."""
    body = stock.bodies[name]
    reducer, request = asked(stock.kinds[name].stem, body, stock.description.folder)
    if request.source is None:
        return None
    with plugins.reading(body.reducer, request):
        return files_hash(reducer.files(request))
