"""Stored super-elements: found by their recipe, used as long as the part file has not changed."""

from __future__ import annotations

import hashlib
import logging
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from ..errors import PartFileError
from . import storage
from .recipe import differences, file_hash, fingerprint
from .super_element import SuperElement
from .travelling import TravellingElement

logger = logging.getLogger("prs_model")

INSTALLED = {"site-packages", "dist-packages"}

Element = SuperElement | TravellingElement


@dataclass(frozen=True)
class StoredPart:
    """Where the super-element of one recipe is kept. folder: the store; files: what it was made from, source first."""

    folder: Path
    stem: str
    recipe: str
    files: tuple[Path, ...]

    @property
    def source(self) -> Path:
        return self.files[0]

    @property
    def path(self) -> Path:
        return self.folder / f"{self.stem}-{fingerprint(self.recipe)}.npz"

    def find(self) -> Element | None:
        """The stored element, or None when there is none or the part file has changed since.

        Raises PartFileError when the file is damaged, or when there is neither a stored element nor a part file.
        """
        if not self.path.exists():
            if not self.source.exists():
                raise PartFileError(self.source, self._nowhere())
            return None
        element = storage.load(self.path)
        if (made_by := provenance(element).get("recipe", "")) != self.recipe:
            what = "; ".join(_differences(self.recipe, made_by)) or "it has none"
            raise PartFileError(self.path, f"holds another recipe than its name says ({what}); delete it")
        if self.source.exists() and provenance(element).get("source_sha256") != files_hash(self.files):
            logger.info("%s: %s has changed since %s was made from it", self.stem, self.source.name, self.path.name)
            return None
        return element

    def keep(self, element: Element) -> None:
        """Store an element. Where the store cannot be written, the next run reduces the part again.

        What pip has installed stays as it was installed.
        """
        if INSTALLED & set(self.folder.resolve().parts):
            logger.info("%s: not stored in %s, which belongs to an installed package", self.stem, self.folder)
            return
        try:
            storage.save(element, self.path)
        except PartFileError as error:
            logger.warning("%s: not stored: %s", self.stem, error)

    def _nowhere(self) -> str:
        others = {path.name: _differences(self.recipe, _recipe_in(path)) for path in self._neighbours()}
        known = {name: what for name, what in others.items() if what and not _is_read_otherwise(what)}
        if not known and (others or not (self.folder.parent / "rebuild.py").exists()):
            return f"there is no such file (relative to the machine's folder); correct bodies.{self.stem}.source"
        sentences = [f"there is no such file, and {self.folder} holds no '{self.path.name}' reduced from it"]
        if known:
            closest = min(sorted(known), key=lambda name: len(known[name]))
            sentences.append(f"'{closest}' there differs in {'; '.join(known[closest])}")
        return "; ".join([*sentences, self._remedy()])

    def _neighbours(self) -> list[Path]:
        return sorted(self.folder.glob(f"{self.stem}-*.npz"))

    def _remedy(self) -> str:
        machine = self.folder.parent
        if (machine / "rebuild.py").exists():
            return f"make the part file with: {rebuild_command(machine)}"
        return "put the part file there, correct 'source', or go back to the settings it was reduced with"


def files_hash(files: Sequence[Path]) -> str:
    """SHA-256 of a file, or of the hashes of several; one that is not there counts as such."""
    hashes = [file_hash(file) if file.is_file() else "" for file in files]
    return hashes[0] if len(hashes) == 1 else hashlib.sha256(" ".join(hashes).encode()).hexdigest()


def _recipe_in(path: Path) -> str:
    """The recipe of a stored file; empty when the file cannot be read."""
    try:
        return provenance(storage.load(path)).get("recipe", "")
    except PartFileError:
        return ""


def _differences(wanted: str, stored: str) -> list[str]:
    try:
        return differences(wanted, stored)
    except (ValueError, RecursionError):  # no recipe
        return []


def _is_read_otherwise(differences: Sequence[str]) -> bool:
    """Whether the stored part comes from another reducer: then it is no near miss."""
    return any(each.startswith("reducer:") for each in differences)


def provenance(element: Element) -> dict[str, str]:
    """Where an element came from; a travelling one's is that of its first station."""
    first = element if isinstance(element, SuperElement) else element.elements[0]
    return dict(first.provenance)


def rebuild_command(machine: Path) -> str:
    """The command that runs a machine folder's own rebuild.py, as a module when the folder is in a package."""
    module, folder = ["rebuild"], machine.resolve()
    while (folder / "__init__.py").exists():
        module.insert(0, folder.name)
        folder = folder.parent
    return f"python -m {'.'.join(module)}" if len(module) > 1 else f"python {machine / 'rebuild.py'}"
