"""What the cross checks look at: a machine file whose sections are sound one by one, and everything beside it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .expand import E, instances, substituted
from .problems import Place, Problems, not_known
from .schema import Body, Closure, Joint, MachineFile
from .urdf import Urdf


@dataclass(frozen=True)
class Subject:
    """`urdf` is None where the URDF is not usable; what needs it is then left unchecked."""

    folder: Path
    raw: Mapping[str, Any]
    file: MachineFile
    urdf: Urdf | None
    bodies: Mapping[str, Body]
    problems: Problems

    def each_joint(self) -> Iterator[tuple[Place, Joint]]:
        """Every instance of every joint, with the place of its entry."""
        return self._each("joints", self.file.joints)

    def each_body(self) -> Iterator[tuple[Place, Body]]:
        """Every instance of every body, with the place of its entry."""
        return self._each("bodies", self.file.bodies)

    def each_closure(self) -> Iterator[tuple[Place, Closure]]:
        """Every instance of every closure, with the place of its entry."""
        return self._each("closures", self.file.closures)

    def _each(self, group: str, entries: Mapping[str, E]) -> Iterator[tuple[Place, E]]:
        for name, entry in entries.items():
            if entry.per is None or entry.per in self.file.symmetry:
                for instance in instances(name, entry.per, self.file.symmetry):
                    yield (group, name), substituted(entry, instance.replacements)

    def check_link(self, place: Place, name: str) -> bool:
        """Whether the URDF has this link; a problem if not."""
        if self.urdf is None or name in self.urdf.links:
            return True
        self.problems.add(place, not_known("a link of the URDF", name, self.urdf.links))
        return False

    def check_node(self, place: Place, name: str, *, ground: bool = False) -> None:
        """``body.interface`` or, where it is allowed, ``ground``; a problem if there is no such thing."""
        if ground and name == "ground":
            return
        body, _, interface = name.partition(".")
        if not interface:
            expected = "'body.interface'" + (" or 'ground'" if ground else "")
            self.problems.add(place, f"found '{name}', expected {expected}")
        elif body not in self.bodies:
            if not self._is_unsound(body):
                self.problems.add(place, not_known("a body", body, self.bodies))
        elif interface not in (known := node_names(self.bodies[body])):
            self.problems.add(place, not_known(f"an interface of body '{body}'", interface, known))

    def _is_unsound(self, body: str) -> bool:
        """Whether a body is missing only because its entry has problems of its own."""
        written = self.raw.get("bodies")
        names = written if isinstance(written, Mapping) else {}
        return any(name not in self.file.bodies and body.startswith(name) for name in names)


def node_names(body: Body) -> list[str]:
    """The interfaces of a body; members of one as ``interface.member``."""
    names = list(body.interfaces)
    for name, interface in body.interfaces.items():
        names += [f"{name}.{member.name}" for member in interface.members]
    return names
