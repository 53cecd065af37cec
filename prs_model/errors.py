"""Every error the library raises on purpose. One base class; each error keeps its values as attributes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path


def short(text: object, limit: int = 120) -> str:
    """Text for a sentence, its middle left out where it is very long."""
    whole, half = str(text), limit // 2
    return whole if len(whole) <= limit else f"{whole[:half]} .. {whole[-half:]}"


class PrsError(Exception):
    """Base of all errors of this library: the input, not the program, is at fault."""


@dataclass(frozen=True)
class Problem:
    """One thing wrong with one entry of a file."""

    file: str
    line: int | None
    entry: str
    message: str

    def __str__(self) -> str:
        place = self.file if self.line is None else f"{self.file}:{self.line}"
        return f"{place}: {self.entry}: {self.message}" if self.entry else f"{place}: {self.message}"


class DescriptionError(PrsError):
    """A machine description or URDF cannot be used; `problems` lists everything found, in file order."""

    def __init__(self, problems: Sequence[Problem]):
        self.problems = tuple(problems)
        super().__init__("\n".join(map(str, self.problems)))


class UnknownNameError(PrsError):
    """A name that is not known, with the ones that are."""

    def __init__(self, what: str, name: str, known: Sequence[str], hint: str = ""):
        self.what, self.name, self.known = what, name, tuple(known)
        listed = ", ".join(self.known) or "none"
        super().__init__(f"unknown {what} '{short(name)}'; known: {listed}" + (f". {hint}" if hint else ""))


class PluginError(PrsError):
    """An installed plug-in that cannot be used: `name` is registered as `value`, and `cause` is what is wrong.

    outcome: how it failed, where it could be loaded.
    """

    def __init__(self, what: str, name: str, value: str, cause: object, outcome: str = "cannot be used"):
        self.what, self.name, self.value, self.cause = what, name, value, cause
        super().__init__(f"{what} '{name}' (installed as {value}) {outcome}: {cause}")


class PartFileError(PrsError):
    """A part file is missing, unreadable or not what it was said to be."""

    def __init__(self, path: Path | str, message: str):
        self.path = Path(path)
        super().__init__(f"{path}: {message}")


class PhysicsError(PrsError):
    """A super-element or system fails a physical check."""

    def __init__(self, subject: str, check: str, figure: float, limit: float, cause: str):
        self.subject, self.check, self.figure, self.limit, self.cause = subject, check, figure, limit, cause
        super().__init__(f"{subject}: {check}: found {figure:.3g}, allowed {limit:.3g}; {cause}")


class UnreachablePoseError(PrsError):
    """No configuration of the machine reaches a pose, or only one beyond a joint limit.

    `joint`, `value`, `limits` are set when a joint limit is the reason (SI units).
    """

    def __init__(
        self,
        message: str,
        *,
        pose: dict[str, float],
        joint: str | None = None,
        value: float | None = None,
        limits: tuple[float, float] | None = None,
    ):
        self.pose, self.joint, self.value, self.limits = pose, joint, value, limits
        super().__init__(message)


class MissingExtraError(PrsError):
    """An optional package is not installed."""

    def __init__(self, package: str, extra: str, purpose: str):
        self.package, self.extra = package, extra
        super().__init__(f"{purpose} needs the package '{package}': install it with pip install 'prs-model[{extra}]'")
