"""Full matrices of all parts: whether a machine has them, and a coarser set of them for a quick look."""

from __future__ import annotations

import logging
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory

from .. import plugins
from ..errors import PartFileError, PrsError
from ..machine import Machine
from ..reduction.request import asked
from ..reduction.store import rebuild_command

logger = logging.getLogger("prs_model")

SCRIPT = "rebuild.py"


def check_full_parts(machine: Machine) -> None:
    """Raise PrsError for parts that come reduced, PartFileError for a part file that is not there."""
    description = machine.description
    bodies, stems = description.bodies, description.stems
    reduced = [name for name, body in bodies.items() if plugins.reducer(body.reducer).gives == "reduced"]
    if reduced:
        others = {stems[name] for name in bodies if name not in reduced}
        told = list(dict.fromkeys(name if stems[name] in others else stems[name] for name in reduced))
        full = [name for name in plugins.list_reducers() if plugins.reducer(name).gives != "reduced"]
        raise PrsError(
            f"{machine.name}: {', '.join(told)} {'come' if len(told) > 1 else 'comes'} reduced, so that there is no "
            f"complete order to verify against; expected parts with full matrices ({', '.join(full)})"
        )
    for name, body in bodies.items():
        source = asked(name, body, description.folder)[1].source
        if source is not None and not source.exists():
            raise PartFileError(source, f"there is no such file, and the complete order needs it; {_remedy(machine)}")


@contextmanager
def rebuilt(folder: Path, size: float) -> Iterator[Path]:
    """A temporary copy of a machine's folder, its parts made anew with element lengths times `size`.

    The folder's own ``rebuild.py --size`` makes them. Raises PrsError when there is none, or when it fails.
    """
    if not (folder / SCRIPT).is_file():
        raise PrsError(
            f"{folder}: found no {SCRIPT}, so that there is no other mesh size; expected a script in the machine's "
            "folder that makes its part files and takes --size FACTOR"
        )
    with TemporaryDirectory(prefix="prs-model-") as place:
        copy = Path(place) / folder.resolve().name
        shutil.copytree(folder, copy, ignore=shutil.ignore_patterns("__pycache__"))
        _rebuild(copy, size)
        yield copy


def _rebuild(folder: Path, size: float) -> None:
    """Run the script as a module where the folder is a package, and pass its lines on."""
    package = (folder / "__init__.py").exists()
    script = ["-m", f"{folder.name}.{Path(SCRIPT).stem}"] if package else [SCRIPT]
    command = [sys.executable, *script, "--size", f"{size:g}"]
    place = folder.parent if package else folder
    process = subprocess.Popen(command, cwd=place, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    said = ""
    with process:
        for line in process.stdout or ():
            said = line.strip() or said
            logger.info("%s", line.rstrip())
    if process.returncode:
        raise PrsError(f"{SCRIPT} --size {size:g} of {folder.name} failed: {said or f'status {process.returncode}'}")


def _remedy(machine: Machine) -> str:
    folder = machine.description.folder
    if (folder / SCRIPT).exists():
        return f"make the part files with: {rebuild_command(folder)}"
    return "put it there, or correct 'source'"
