"""The kit finds the faults it is there for: reducers with one fault each, and a sound one."""

import re
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import prs_model as prs
from prs_model import plugins
from prs_model.testing import Sample, as_text, conformance, damage, damage_table
from prs_model.testing.element import plain_element
from prs_model.testing.receptance import Whole, difference, first_eigenvalue, receptances
from prs_model.testing.variants import variants

CODE = '''
import logging, os, signal, sys, time
import numpy as np
from prs_model import PartFileError, Reducer
from prs_model.description.schema import Section
from prs_model.part_files import read_text
from prs_model.testing.element import plain_element
from dataclasses import replace

class Options(Section):
    """None."""

class Sound(Reducer):
    description, Options, gives, units = "a scale of the plain part, and its end", Options, "reduced", "SI"

    def read(self, part):
        words = read_text(part.path).split()
        if len(words) != 3 or words[0] != words[1] or words[2] != "end":
            return self.odd(part, words)
        return scaled(float(words[0]))

    def odd(self, part, words):
        raise PartFileError(part.path, "expected a number twice and 'end'")

def scaled(factor):
    element = plain_element()
    return replace(element, mass=element.mass * factor, stiffness=element.stiffness * factor, provenance={})

class Careless(Sound):
    def odd(self, part, words):
        return scaled(2.0) if words[-1] == "end" else super().odd(part, words)

class Crashing(Sound):
    def odd(self, part, words):
        os.kill(os.getpid(), signal.SIGSEGV)

class Raising(Sound):
    def odd(self, part, words):
        return words[10]

class Chatty(Careless):
    def odd(self, part, words):
        logging.getLogger("prs_model").warning("modes 3 and 4 are a pair")
        return super().odd(part, words)

class Misplacing(Sound):
    writes = (".txt",)

    def write(self, element, path, units):
        path.write_text("7 7 end")

    def read(self, part):
        element = super().read(part)
        written = element.mass[0, 0] > 10.0
        return replace(plain_element(), positions=1000.0 * element.positions) if written else element

class Hanging(Sound):
    def odd(self, part, words):
        time.sleep(60)

class Greedy(Sound):
    def odd(self, part, words):
        return np.ones(4 << 27)

class Printing(Sound):
    def read(self, part):
        os.write(1, b"reading ..")
        return super().read(part)

class Changing(Sound):
    def read(self, part):
        element = super().read(part)
        part.path.with_suffix(".bak").write_text("kept")
        return element

class Secretive(Sound):
    def read(self, part):
        if not part.path.with_name("beside.txt").exists():
            raise PartFileError(part.path, "beside.txt is not there")
        return super().read(part)

class Forgetful(Sound):
    def read(self, part):
        return scaled(1.0 + 1e-6 * np.random.default_rng().random())

class Undocumented(Sound):
    Options = type("Bare", (Section,), {})
'''
NAMES = re.findall(r"^class (\w+)\((?!Section)", CODE, re.MULTILINE)


@pytest.fixture
def sample(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Callable[[str], Sample]]:
    """A sample for each of the reducers above, which are installed as `kit_...`."""
    monkeypatch.setattr(damage, "SECONDS", 1.0)
    (tmp_path / "kit_reducers.py").write_text(CODE)
    info = tmp_path / "kit_reducers-1.0.dist-info"
    info.mkdir()
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: kit-reducers\nVersion: 1.0\n")
    points = "\n".join(f"kit_{name.lower()} = kit_reducers:{name}" for name in NAMES)
    (info / "entry_points.txt").write_text(f"[prs_model.reducers]\n{points}\n")
    (tmp_path / "part").mkdir()
    part = tmp_path / "part" / "plain.txt"
    part.write_text("1.000000\n1.000000\nend\n")
    (part.parent / "beside.txt").write_text("here")
    monkeypatch.syspath_prepend(tmp_path)
    plugins._found.cache_clear()
    interfaces = {"a": {"node": "11"}, "b": {"node": "23"}}
    yield lambda name: Sample(f"kit_{name}", part, interfaces=interfaces, mass=3.5)
    plugins._found.cache_clear()


def failing(sample: Sample, *, but: str = "damage_is_noticed") -> list[str]:
    """Names of the checks that fail, without one that takes long."""
    failed = []
    for check in conformance(sample):
        if str(check) == but:
            continue
        try:
            check()
        except AssertionError as error:
            failed.append(str(check) if (check.promise.__doc__ or "") in str(error) else str(error))
    return failed


def test_a_sound_reducer_passes(sample: Callable[[str], Sample]) -> None:
    assert failing(sample("sound"), but="") == []
    table = damage_table(sample("sound"))
    assert len(table) >= 14
    assert {each.result for each in table} <= {"refused", "same"}, as_text(table)


@pytest.mark.parametrize(
    ("name", "promises"),
    [
        ("printing", ["nothing_is_printed"]),
        ("changing", ["files_stay_as_they_are"]),
        ("undocumented", ["options_are_documented"]),
        ("misplacing", ["what_is_written_reads_back"]),
    ],
)
def test_each_fault_fails_its_check_only(sample: Callable[[str], Sample], name: str, promises: list[str]) -> None:
    assert failing(sample(name)) == promises


@pytest.mark.parametrize(
    ("name", "promise"),
    [
        ("secretive", "files_names_every_file"),
        ("forgetful", "reading_twice_gives_the_same"),
        ("crashing", "damage_is_noticed"),
        ("crashing", "files_without_sense_are_refused"),
    ],
)
def test_faults_that_show_in_several_checks(sample: Callable[[str], Sample], name: str, promise: str) -> None:
    checks = {str(check): check for check in conformance(sample(name))}
    with pytest.raises((AssertionError, prs.PartFileError)):
        checks[promise]()


@pytest.mark.parametrize(
    ("name", "result", "said"),
    [
        ("careless", "wrong", "differs by"),
        ("chatty", "wrong", "differs by"),
        ("crashing", "crash", "SIGSEGV"),
        ("raising", "crash", "report it to its author"),
        ("greedy", "memory", "more memory"),
    ],
)
def test_damage_that_is_taken_badly(sample: Callable[[str], Sample], name: str, result: str, said: str) -> None:
    table = damage_table(sample(name), places=1)
    faults = [each for each in table if each.is_fault]
    assert Counter(each.result for each in faults).keys() == {result}, as_text(table)
    assert all(said in each.message for each in faults)


def test_a_reader_that_hangs_is_ended(sample: Callable[[str], Sample], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(damage, "SECONDS", 0.2)
    faults = [each for each in damage_table(sample("hanging"), places=1) if each.is_fault]
    assert {each.result for each in faults} == {"hang"}
    assert all(each.seconds < 1.0 for each in faults)


def test_what_nothing_can_notice_is_said_with_its_reason(sample: Callable[[str], Sample]) -> None:
    careless = replace(sample("careless"), unseen={"plain.txt: another digit*": "the number stands there once"})
    seen = {each.damage: each for each in damage_table(careless, places=1)}
    assert seen["another digit"].result == "unseen"
    assert "the number stands there once" in seen["another digit"].message
    assert seen["a line twice"].result == "wrong"


def test_a_sample_that_is_no_good_is_said_to_be(sample: Callable[[str], Sample]) -> None:
    heavier = replace(sample("sound"), mass=3.6)
    assert failing(heavier) == ["figures_are_as_stated"]
    rigid = Sample("rigid", options={"mass": 1.0, "nodes": {"a": (0.0, 0.0, 0.0)}}, interfaces={"a": {}}, mass=1.0)
    assert failing(rigid) == []
    for stated in ((1234.5,), (1.0, 2.0)):  # a rigid body has none
        assert failing(replace(rigid, free=stated)) == ["figures_are_as_stated"]
        assert failing(replace(rigid, fixed=stated)) == ["figures_are_as_stated"]
    lost = replace(sample("sound"), interfaces={"a": {"node": "12"}})
    with pytest.raises(prs.PrsError, match=r"the undamaged sample cannot be read: .*found '12'"):
        damage_table(lost)


def test_receptances_know_a_part_by_its_answers() -> None:
    """Other coordinates are the same part; another modal stiffness or another order of nodes is not, or is."""
    element = plain_element()
    eigenvalue = first_eigenvalue(element)
    own = receptances(element, eigenvalue)
    turn = np.linalg.qr(np.random.default_rng(1).standard_normal((14, 14)))[0]
    turned = replace(
        element,
        stiffness=turn.T @ element.stiffness @ turn,
        mass=turn.T @ element.mass @ turn,
        motions=element.motions @ turn,
    )
    assert difference(receptances(turned, eigenvalue), own) < 1e-9
    reordered = replace(
        element, nodes=element.nodes[::-1], positions=element.positions[::-1], motions=element.motions[::-1]
    )
    assert difference(receptances(reordered, eigenvalue), own) < 1e-9
    stiffness = element.stiffness.copy()
    stiffness[-1, -1] *= 1.001
    assert difference(receptances(replace(element, stiffness=stiffness), eigenvalue), own) > 1e-6


@pytest.mark.parametrize(
    "change",
    [{"positions": 1000.0 * plain_element().positions}, {"grounded": True}, {"n_modes": 1}],
    ids=["places", "ground", "modes"],
)
def test_a_part_is_its_places_and_its_kind_too(change: dict[str, object]) -> None:
    whole = Whole(plain_element())
    assert whole.difference(plain_element()) == 0.0
    assert whole.difference(replace(plain_element(), **change)) > 1.0


@pytest.mark.parametrize("content", [b"node 1 0.5\nnode 2 1.5\nend\n" * 10, bytes(range(256)) * 4])
def test_variants_are_many_and_the_same_each_time(content: bytes) -> None:
    found = {variant.name: variant(content, "part.x") for variant in variants(content, 2)}
    assert len(found) >= 14
    assert found == {variant.name: variant(content, "part.x") for variant in variants(content, 2)}
    assert sum(changed != content for changed in found.values()) >= 14
