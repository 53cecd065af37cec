"""What the cross checks look at: a machine file whose sections are sound one by one, and everything beside it."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from .. import plugins
from ..errors import PluginError, UnknownNameError
from .expand import E, instances, substituted
from .problems import Place, Problems, not_known
from .schema import Body, Closure, Joint, MachineFile
from .settings import Settings
from .urdf import Urdf


@dataclass(frozen=True)
class Subject:
    """`urdf` is None where the URDF is not usable; what needs it is then left unchecked.

    `origins` names the entry that one written for an instance alone was split from.
    """

    folder: Path
    raw: Mapping[str, Any]
    file: MachineFile
    urdf: Urdf | None
    bodies: Mapping[str, Body]
    problems: Problems
    origins: Mapping[str, str] = field(default_factory=dict)

    def each_joint(self) -> Iterator[tuple[Place, str, Joint]]:
        """Every instance of every joint: the place of its entry, its own name, and itself."""
        return self._each("joints", self.file.joints)

    def each_body(self) -> Iterator[tuple[Place, str, Body]]:
        """Every instance of every body, likewise."""
        return self._each("bodies", self.file.bodies)

    def each_closure(self) -> Iterator[tuple[Place, str, Closure]]:
        """Every instance of every closure, likewise."""
        return self._each("closures", self.file.closures)

    def _each(self, group: str, entries: Mapping[str, E]) -> Iterator[tuple[Place, str, E]]:
        for name, entry in entries.items():
            if entry.per is None or entry.per in self.file.symmetry:
                for instance in instances(name, entry.per, self.file.symmetry):
                    yield (group, name), instance.name, substituted(entry, instance.replacements)

    def check_link(self, place: Place, name: str) -> bool:
        """Whether the URDF has this link; a problem if not."""
        if self.urdf is None or name in self.urdf.links:
            return True
        self.problems.add(place, not_known("a link of the URDF", name, self.urdf.links))
        return False

    def check_node(self, place: Place, name: str) -> None:
        """``body.interface`` or ``body.interface.member``, a node that the body keeps; a problem if it does not."""
        self._check_reference(place, name, node_names, "'body.interface'")

    def check_end(self, place: Place, name: str) -> None:
        """What a joint may be between: ``ground``, an interface, or a node of one; a problem if it is none."""
        if name != "ground":
            self._check_reference(place, name, end_names, "'body.interface' or 'ground'")

    def _check_reference(
        self, place: Place, name: str, names: Callable[[Body, Settings], list[str]], expected: str
    ) -> None:
        body, _, node = name.partition(".")
        if not node:
            self.problems.add(place, f"found '{name}', expected {expected}")
        elif body not in self.bodies:
            if not self._is_unsound(body):
                self.problems.add(place, not_known("a body", body, self.bodies))
        elif node not in (known := names(self.bodies[body], self._settings(self.bodies[body]))):
            told = not_known(f"an interface of body '{body}'", node, known)
            self.problems.add(place, told + _advice(self.bodies[body], node))

    def _settings(self, body: Body) -> Settings:
        """How a body is reduced; what comes reduced is not loaded by joints."""
        settings = Settings.of(body, self.file.reduction)
        try:
            comes_reduced = plugins.reducer(body.reducer).gives == "reduced"
        except (UnknownNameError, PluginError):  # told at the body's own entry
            comes_reduced = False
        return replace(settings, method="craig-bampton") if comes_reduced else settings

    def _is_unsound(self, body: str) -> bool:
        """Whether a body is missing only because its entry has problems of its own."""
        written = self.raw.get("bodies")
        names = written if isinstance(written, Mapping) else {}
        return any(name not in self.file.bodies and body.startswith(name) for name in names)


def node_names(body: Body, settings: Settings) -> list[str]:
    """The nodes a body keeps: one per interface, or one per member of an interface tied there."""
    names: list[str] = []
    for name, interface in body.interfaces.items():
        apart = settings.tie_of(interface) == "interface"
        names += [f"{name}.{member.name}" for member in interface.members if apart]
        names += [] if apart and interface.members else [name]
    return names


def end_names(body: Body, settings: Settings) -> list[str]:
    """What joints may take hold of: every interface as a whole, and every node."""
    return list(dict.fromkeys([*body.interfaces, *node_names(body, settings)]))


def _advice(body: Body, node: str) -> str:
    name, _, member = node.partition(".")
    members = [each.name for each in body.interfaces[name].members] if name in body.interfaces else []
    if member in members:
        return f"; '{name}' has one node for all its members: name '{name}', or give it 'tie: interface'"
    return f"; '{name}' has a node for each of its members" if members and not member else ""
