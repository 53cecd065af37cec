"""A description with some entries changed; the original stays as it is."""

from __future__ import annotations

import re
from collections.abc import Mapping
from pathlib import PurePath
from typing import Any

from ..errors import DescriptionError, Problem
from .expand import Instance, instances, substituted
from .fields import is_free, known_fields
from .load import MachineDescription, described
from .problems import Place, did_you_mean, dotted, listed
from .schema import MachineFile

_STEP = re.compile(r"([^.\[\]]+)|\[([0-9]+)\]")
_PLACEHOLDER = re.compile(r"_?<[^<>]*>")
_PATH = re.compile(r"[^.\[\]]+(\.[^.\[\]]+|\[[0-9]+\])*")


def replaced(description: MachineDescription, changes: Mapping[str, object]) -> MachineDescription:
    """A new description with entries changed, such as ``{"joints.R.interfaces[0].stiffness.ux": 1e6}``.

    Paths are those of machine.yaml as written; an entry of a list goes by its number or its name (``interfaces.left``,
    ``stages.s3``). The name of an instance (``bodies.rod_2.modes``) splits its entry
    into instances of their own first. Values are in the units of the file and are validated together with the rest.
    Raises DescriptionError for a path that does not exist, with the nearest one that does, and as loading does.
    """
    draft = _Draft(description)
    for path, value in changes.items():
        draft.change(path, _plain(value))
    return described(description.path, draft.raw, draft.lines, draft.origins)


def parse_path(path: str) -> Place:
    """``joints.R.interfaces[0]`` as ``("joints", "R", "interfaces", 0)``; empty for what is no path."""
    if not _PATH.fullmatch(path):
        return ()
    return tuple(int(index) if index else key for key, index in _STEP.findall(path))


class _Draft:
    """A copy of the file's content that can be changed."""

    def __init__(self, description: MachineDescription):
        self.file = description.path.name
        self.symmetry = description.file.symmetry
        self.made: dict[Place, Mapping[str, Any]] = {
            ("bodies",): description.bodies,
            ("joints",): description.joints,
            ("closures",): description.closures,
        }
        self.raw: dict[str, Any] = dict(description.raw)
        self.lines = dict(description.lines)
        written = {name for group in ("bodies", "joints", "closures") for name in getattr(description.file, group)}
        self.origins = {name: stem for name, stem in description.stems.items() if name in written}

    def change(self, path: str, value: Any) -> None:
        place = parse_path(path)
        if not place:
            raise self._refuse(path, "found a path that cannot be read, expected one such as bodies.rod.modes")
        if len(place) > 1:
            self._split(str(place[0]), str(place[1]))
        place = self._numbered(place)
        self.raw = self._changed(self.raw, place, (), value)
        self.lines = {at: line for at, line in self.lines.items() if at[: len(place)] != place}
        self.lines[place] = None

    def _numbered(self, place: Place) -> Place:
        """The place with entries of lists, where they go by their name or URDF joint, by their number."""
        raw: Any = self.raw
        steps: list[str | int] = []
        for step in place:
            if isinstance(raw, tuple) and isinstance(step, str):
                names = [_name_of(each) for each in raw]
                if step not in names:
                    known = listed([name for name in names if name], 30)
                    message = f"found '{step}' in a list, expected one of {known}, or a number such as [0]"
                    raise self._refuse(dotted(place), message)
                step = names.index(step)
            steps.append(step)
            inside = isinstance(raw, Mapping) or (isinstance(raw, tuple) and isinstance(step, int) and step < len(raw))
            raw = (raw.get(step) if isinstance(raw, Mapping) else raw[step]) if inside else None
        return tuple(steps)

    def _changed(self, raw: Any, place: Place, done: Place, value: Any) -> Any:
        """A copy of `raw`, which stands at `done`, with the entry at `place` replaced."""
        if len(done) == len(place):
            return value
        step = place[len(done)]
        here = (*done, step)
        if isinstance(step, int):
            if not isinstance(raw, tuple) or step >= len(raw):
                found = f"a list of {len(raw)} (counted from 0)" if isinstance(raw, tuple) else "no list"
                raise self._refuse(dotted(place), f"found {found} at {dotted(done)}, expected an entry [{step}]")
            changed = self._changed(raw[step], place, here, value)
            return (*raw[:step], changed, *raw[step + 1 :])
        entries = {} if raw is None else raw
        self._check_step(entries, place, here, value)
        return {**entries, step: self._changed(entries.get(step), place, here, value)}

    def _check_step(self, entries: Any, place: Place, here: Place, value: Any) -> None:
        """A key must be there, or be one that the section may have, or carry a whole new entry of the user's."""
        done, step = here[:-1], str(here[-1])
        fields = known_fields(MachineFile, done)
        checked = "options" in done or done == ("damping", "joints")  # by the reducer, and against the names of joints
        new = is_free(MachineFile, done) and (checked or (here == place and isinstance(value, Mapping)))
        if isinstance(entries, Mapping) and (step in entries or step in fields or new):
            return
        written = entries if isinstance(entries, Mapping) else ()
        known = list(dict.fromkeys([*written, *fields, *self.made.get(done, ())]))
        where = f"of {dotted(done)}" if done else "of the file"
        message = f"found no such entry; entries {where} are {listed(known, 30)}{did_you_mean(step, known)}"
        raise self._refuse(dotted(place), message)

    def _refuse(self, path: str, message: str) -> DescriptionError:
        return DescriptionError([Problem(self.file, None, path, message)])

    def _split(self, group: str, name: str) -> None:
        """Write the entry that makes the instance `name` as instances of their own, if there is one."""
        entries = self.raw.get(group)
        if group not in ("bodies", "joints", "closures") or not isinstance(entries, Mapping) or name in entries:
            return
        for entry, content in entries.items():
            made = list(instances(entry, content.get("per"), self.symmetry))
            if name in [instance.name for instance in made]:
                bare = {key: value for key, value in content.items() if key != "per"}
                written = {instance.name: substituted(bare, instance.replacements) for instance in made}
                self.raw[group] = _in_place_of(entries, entry, written)
                for instance in made:
                    self._place_instance(group, instance)
                return

    def _place_instance(self, group: str, instance: Instance) -> None:
        """An instance keeps the lines of its entry, and its stem."""
        entry = instance.entry
        self.origins[instance.name] = self.origins.get(entry) or entry
        for at, line in list(self.lines.items()):
            if at[:2] == (group, entry):
                inside: Place = substituted(at[2:], instance.replacements)
                self.lines[(group, instance.name, *inside)] = line


def _in_place_of(entries: Mapping[str, Any], name: str, others: Mapping[str, Any]) -> dict[str, Any]:
    """The entries with one exchanged for several, in its place."""
    exchanged: dict[str, Any] = {}
    for key, value in entries.items():
        exchanged.update(others if key == name else {key: value})
    return exchanged


def _name_of(entry: Any) -> str | None:
    """What an entry of a list goes by: its name, or its URDF joint without the placeholder."""
    if not isinstance(entry, Mapping):
        return None
    name = entry.get("name", entry.get("urdf"))
    return _PLACEHOLDER.sub("", name) if isinstance(name, str) else None


def _plain(value: Any) -> Any:
    """Lists as tuples, NumPy values as Python's, paths as text: what the YAML loader would have given."""
    if hasattr(value, "tolist"):
        value = value.tolist()
    if isinstance(value, PurePath):
        return str(value)
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return tuple(_plain(item) for item in value)
    return value
