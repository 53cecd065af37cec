"""What every reducer promises, one check a promise."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from contextlib import chdir
from dataclasses import dataclass, replace
from pathlib import Path
from tempfile import TemporaryDirectory, TemporaryFile

import numpy as np

from ..description.schema import Section
from ..description.units import Dimension, Units
from ..errors import PrsError
from ..reduction import SuperElement
from ..reduction.summary import summarize
from .damage import as_text, damage_table, read_apart
from .element import plain_element
from .pipes import standard_output_to
from .receptance import ALIKE, Whole
from .sample import Sample, figures
from .variants import ANOTHER_KIND, PROSE

Promise = Callable[[Sample], None]


@dataclass(frozen=True)
class Check:
    """A promise about a sample. Called, it returns, or raises AssertionError with the promise and what was found."""

    sample: Sample
    promise: Promise

    def __str__(self) -> str:
        return self.promise.__name__

    def __call__(self) -> None:
        try:
            self.promise(self.sample)
        except AssertionError as error:
            raise AssertionError(f"reducer '{self.sample.reducer}': {self.promise.__doc__} Found: {error}") from error


def conformance(sample: Sample) -> tuple[Check, ...]:
    """The checks for a sample, to be called one by one; with pytest:

    ``@pytest.mark.parametrize("check", conformance(SAMPLE), ids=str)`` on ``def test_conformance(check): check()``.
    """
    plugin = sample.plugin
    promises = [*OF_ALL, *(OF_FILES if plugin.needs_source else ())]
    if plugin.needs_source and plugin.units != "SI":
        promises.append(lengths_follow_the_units)
    if plugin.writes:
        promises.append(what_is_written_reads_back)
    return tuple(Check(sample, promise) for promise in promises)


def description_is_one_line(sample: Sample) -> None:
    """The description is one line of text."""
    text = sample.plugin.description
    _require(bool(text.strip()) and len(text.splitlines()) == 1 and len(text) <= 100, repr(text))


def options_are_documented(sample: Sample) -> None:
    """Options are a Section with a docstring of its own."""
    options = sample.plugin.Options
    _require(issubclass(options, Section), f"{options.__name__} is no subclass of Section")
    _require(bool((options.__doc__ or "").strip()), f"{options.__name__} has no docstring")


def unknown_options_are_refused(sample: Sample) -> None:
    """An option that does not exist is refused by name."""
    wrong = replace(sample, options={**sample.options, "no_such_option": 1})
    try:
        wrong.read()
    except PrsError as error:
        _require("no_such_option" in str(error), f"a refusal that does not name it: {error}")
    else:
        raise AssertionError("it was read")


def the_gate_passes(sample: Sample) -> None:
    """The part at its interfaces passes the physics gate."""
    try:
        sample.reduce().check()
    except PrsError as error:
        raise AssertionError(str(error)) from error


def figures_are_as_stated(sample: Sample) -> None:
    """Mass and first frequencies are those that the sample states."""
    _require(bool(sample.mass or sample.free or sample.fixed), "the sample states neither mass nor frequencies")
    found = figures(sample, max(1, len(sample.free)))
    if sample.mass is not None:
        _require(found.mass is not None, "a part that is held, whose mass cannot be told: leave 'mass' out")
        _close("mass [kg]", np.array([found.mass]), (sample.mass,), sample.accuracy)
    _close("free frequencies [Hz]", found.free[: len(sample.free)], sample.free, sample.accuracy)
    if sample.fixed:
        fixed = summarize(sample.reduce(), len(sample.fixed)).fixed
        _close("fixed frequencies [Hz]", fixed, sample.fixed, sample.accuracy)


def reading_twice_gives_the_same(sample: Sample) -> None:
    """Read twice, the part is the same, to the last bit."""
    one, two = sample.read(), sample.read()
    for name in ("stiffness", "mass"):
        apart = getattr(one, name) - getattr(two, name)
        _require(not np.any(apart if isinstance(apart, np.ndarray) else apart.data), f"another {name}")


def nothing_is_printed(sample: Sample) -> None:
    """Nothing appears on standard output, not even from compiled libraries."""
    with TemporaryFile() as file, standard_output_to(file.fileno()):
        sample.read()
        file.seek(0)
        printed = file.read()
    _require(not printed, repr(printed[:200]))


def files_without_sense_are_refused(sample: Sample) -> None:
    """A file that is missing, empty, a folder or of another kind is refused by its name."""
    contents = {"missing": None, "empty": b"", "a picture": ANOTHER_KIND, "prose": PROSE}
    with TemporaryDirectory() as name:
        copies = {what: sample.copied(Path(name) / what) for what in (*contents, "a folder")}
        for what, copy in copies.items():
            copy.path.unlink()
            if what == "a folder":
                copy.path.mkdir()
            elif (content := contents[what]) is not None:
                copy.path.write_bytes(content)
        answers = dict(zip(copies, read_apart(sample, list(copies.values())), strict=True))
    for what, answer in answers.items():
        _require(answer["result"] == "refused", f"{what}: {answer['result']} {answer['message']}")
        _require(sample.path.name in answer["message"], f"{what}: a refusal without its name: {answer['message']}")


def files_names_every_file(sample: Sample) -> None:
    """The part reads the same where nothing is but the files that `files` names."""
    _require(sample.files()[:1] == (sample.path,), f"'files' does not begin with the source: {sample.files()[:1]}")
    with TemporaryDirectory() as name:
        _same(sample.copied(Path(name)).reduce(), sample.reduce())


def files_stay_as_they_are(sample: Sample) -> None:
    """Reading changes none of the part's files, and makes none beside them."""
    with TemporaryDirectory() as name:
        copy = sample.copied(Path(name))
        before = _contents(Path(name))
        copy.reduce()
        after = _contents(Path(name))
    changed = sorted(path for path in before.keys() | after.keys() if before.get(path) != after.get(path))
    _require(not changed, ", ".join(changed))


def any_working_directory_will_do(sample: Sample) -> None:
    """The part reads the same from any working directory, and under a path relative to it."""
    with TemporaryDirectory() as name:
        copy, expected = sample.copied(Path(name) / "part"), sample.reduce()
        with chdir(name):
            _same(copy.reduce(), expected)
            _same(replace(copy, source=copy.path.relative_to(name)).reduce(), expected)
        with chdir(copy.path.parent):
            _same(replace(copy, source=copy.path.name).reduce(), expected)


def damage_is_noticed(sample: Sample) -> None:
    """Damaged files are refused or noticed, and never crash, hang, fill the memory or give another part silently."""
    faults = [each for each in damage_table(sample) if each.is_fault]
    _require(not faults, "\n" + as_text(faults))


def lengths_follow_the_units(sample: Sample) -> None:
    """In other units all figures follow, as of matrices or of a shape; a file that says its units refuses others."""
    said = Units.parse(sample.units) if sample.units else Units()
    other = "mm-N-tonne-s" if said.length != "mm" else "m-N-kg-s"
    one = figures(sample)
    try:
        two = figures(replace(sample, units=other))
    except PrsError as error:
        _require("units" in str(error), f"in {other} it is refused: {error}")
        return
    length, mass = (
        dimension.factor(Units.parse(other)) / dimension.factor(said)
        for dimension in (Dimension(length=1), Dimension(mass=1))
    )
    _close("size [m]", two.size, one.size * length, ALIKE)
    laws = {"matrices": (mass, 1.0), "shape": (length**3, 1.0 / length)}
    found = (two.mass or 1.0) / (one.mass or 1.0), float(two.free[0] / one.free[0]) if one.free.size else 1.0
    heavier = [law if one.mass is not None else (1.0, law[1]) for law in laws.values()]
    _require(
        any(np.allclose(found, law, rtol=1e-6, atol=0.0) for law in heavier),
        f"in {other} mass changes by {found[0]:.6g} and the first frequency by {found[1]:.6g}, expected one of "
        + ", ".join(f"{law[0]:.6g} and {law[1]:.6g} ({kind})" for kind, law in laws.items()),
    )


def what_is_written_reads_back(sample: Sample) -> None:
    """What the reducer writes it reads back to nine digits, in any units that it takes."""
    plugin, element = sample.plugin, plain_element()
    for suffix in plugin.writes:
        for units in ("m-N-kg-s",) if plugin.units == "SI" else ("m-N-kg-s", "mm-N-tonne-s"):
            with TemporaryDirectory() as name:
                path = Path(name) / f"part{suffix}"
                plugin.write(element, path, Units.parse(units))
                read = Sample(sample.reducer, path, None if plugin.units == "SI" else units).read()
            if not isinstance(read, SuperElement):
                raise AssertionError(f"{suffix} in {units}: a {type(read).__name__}, expected a SuperElement")
            _same(read, element)


OF_ALL: tuple[Promise, ...] = (
    description_is_one_line,
    options_are_documented,
    unknown_options_are_refused,
    the_gate_passes,
    figures_are_as_stated,
    reading_twice_gives_the_same,
    nothing_is_printed,
)
OF_FILES: tuple[Promise, ...] = (
    files_without_sense_are_refused,
    files_names_every_file,
    files_stay_as_they_are,
    any_working_directory_will_do,
    damage_is_noticed,
)


def _require(truth: bool, found: str) -> None:
    if not truth:
        raise AssertionError(found)


def _close(what: str, found: np.ndarray, expected: object, accuracy: float) -> None:
    wanted = np.asarray(expected)
    if np.shape(found) != wanted.shape or not np.allclose(found, wanted, rtol=accuracy, atol=0.0):
        raise AssertionError(f"{what}: {found}, expected {expected} to {accuracy:g}")


def _same(found: SuperElement, expected: SuperElement) -> None:
    for what in ("nodes", "n_modes", "grounded"):
        one, other = getattr(found, what), getattr(expected, what)
        alike = sorted(one) == sorted(other) if what == "nodes" else one == other
        _require(alike, f"{what} {one}, expected {other}")
    apart = Whole(expected).difference(found)
    _require(apart <= ALIKE, f"places or receptances that differ by {apart:.1e}")


def _contents(folder: Path) -> dict[str, str]:
    return {
        str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).hexdigest()
        for path in folder.rglob("*")
        if path.is_file()
    }
