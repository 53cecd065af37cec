"""The page: one file that needs nothing else, filled from a template."""

from __future__ import annotations

import json
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import MissingExtraError
from ..readable import figure, readable, readable_range
from ..response.quantity import DIRECTIONS, unit
from .embedding import embedded
from .published import published_shares
from .script_data import script_data

if TYPE_CHECKING:
    from ..machine import Machine
    from .card import Joint, Part
    from .figures import Figure
    from .scene import Scene
    from .sources import Entry
    from .study import Study

_ASSETS = Path(__file__).parent / "assets"
_SCRIPTS = ("viewer.js", "chart.js", "page.js")


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
    command: str
    map: Figure | None = None
    map_files: tuple[str, ...] = ()


def page(content: Content, folder: Path) -> str:
    """The page's text; figures are read from the folders of the poses in `folder`. Raises MissingExtraError."""
    from .. import __version__

    file = content.machine.description.file
    template = environment().get_template("page.html.jinja")
    return str(
        template.render(
            content=content,
            machine=content.machine,
            file=file,
            verification=file.verification,
            version=__version__,
            style=(_ASSETS / "style.css").read_text(encoding="utf-8"),
            scripts=[(_ASSETS / name).read_text(encoding="utf-8") for name in _SCRIPTS],
            data=_script_safe(json.dumps(script_data(content.poses), separators=(",", ":"))),
            shares=[published_shares(pose.study, file.verification) for pose in content.poses],
            image=lambda pose, name: embedded(folder / pose.study.folder / name),
            map_image=None if content.map is None else embedded(folder / f"{content.map.name}.png"),
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
