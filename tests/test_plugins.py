"""Plug-ins of other distributions: sound ones are found, broken ones are named and break nothing else."""

import inspect
import json
import logging
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

import prs_model as prs
from prs_model import plugins
from prs_model.cli import main

CODE = """
from prs_model import Reducer
from prs_reducers.rigid import RigidReducer, RigidOptions

class Nameless(Reducer):
    Options = RigidOptions
    def read(self, part): ...

class Angry(RigidReducer):
    def __init__(self): raise OSError("no licence")

class Reducd(RigidReducer):
    gives = "reducd"

class Greedy(RigidReducer):
    class Options(RigidOptions):
        modes: int = 3

class Failing(RigidReducer):
    needs_source = True
    units = "SI"
    def read(self, part): return {}["pts"]

class Empty(Failing):
    def read(self, part): return None

number = 3
"""

REDUCERS = {
    "absent": ("no_such_module:Thing", "ModuleNotFoundError: No module named 'no_such_module'"),
    "angry": ("elsewhere:Angry", "OSError: no licence"),
    "greedy": ("elsewhere:Greedy", "found an option 'modes', which is an argument of prs_model.reduce"),
    "reducd": ("elsewhere:Reducd", "found gives = 'reducd' in Reducd, expected one of full, reduced, either"),
    "nameless": ("elsewhere:Nameless", "found no 'description' in Nameless"),
    "number": ("elsewhere:number", "found 3, expected a subclass of prs_model.Reducer"),
}
MACHINES = {
    "module": ("elsewhere", "found a module, expected a package"),
    "gone": ("no_such_package", "found no such package"),
    "astray": ("no_such_package.machine", "ModuleNotFoundError"),
}

Install = Callable[[str, dict[str, dict[str, str]]], None]


@pytest.fixture
def install(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Install]:
    """Puts a distribution with entry points on the path."""

    def install(name: str, groups: dict[str, dict[str, str]]) -> None:
        info = tmp_path / f"{name}-1.0.dist-info"
        info.mkdir(parents=True)
        (info / "METADATA").write_text(f"Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n")
        lines = [
            line
            for group, points in groups.items()
            for line in (f"[prs_model.{group}]", *(f"{point} = {value}" for point, value in points.items()))
        ]
        (info / "entry_points.txt").write_text("\n".join(lines))

    (tmp_path / "elsewhere.py").write_text(CODE)
    monkeypatch.syspath_prepend(tmp_path)
    plugins._found.cache_clear()
    yield install
    plugins._found.cache_clear()


def test_broken_reducers_are_named_with_their_cause(
    install: Install, caplog: pytest.LogCaptureFixture, capsys: pytest.CaptureFixture[str]
) -> None:
    install("broken", {"reducers": {name: value for name, (value, _) in REDUCERS.items()}})
    for name, (value, cause) in REDUCERS.items():
        with pytest.raises(prs.PluginError) as caught:
            plugins.reducer(name)
        assert str(caught.value).startswith(f"reducer '{name}' (installed as {value}) cannot be used: {cause}")
        assert (caught.value.name, caught.value.value) == (name, value)
    listed = prs.list_reducers()
    assert "solid" in listed
    assert not REDUCERS.keys() & listed.keys()
    assert len(caplog.records) == len(REDUCERS)
    assert main(["reducers", "--json"]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)["reducers"]}
    assert rows["solid"]["problem"] is None
    assert all(cause in rows[name]["problem"] for name, (_, cause) in REDUCERS.items())


@pytest.mark.parametrize(
    ("name", "cause"), [("failing", "KeyError: 'pts'"), ("empty", "it gave None, expected a Super")]
)
def test_a_reducer_that_fails_is_named_with_its_package_and_the_file(
    install: Install, tmp_path: Path, name: str, cause: str
) -> None:
    (source := tmp_path / "bad.tri").touch()
    install("lab", {"reducers": {name: f"elsewhere:{name.title()}"}})
    for use in (prs.reduce, prs.read_part):
        with pytest.raises(prs.PluginError) as caught:
            use(name, source, options={"mass": 1.0, "nodes": {"a": (0.0, 0.0, 0.0)}})
        said = f"reducer '{name}' (installed as elsewhere:{name.title()} of lab) failed on {source}: {cause}"
        assert str(caught.value).startswith(said)
        assert str(caught.value).endswith("; report it to its author")


def test_no_option_can_hide_an_argument_of_reduce() -> None:
    named = set(inspect.signature(prs.reduce).parameters) - {"nodes", "more"}
    assert named == plugins.TAKEN


def test_broken_machines_are_listed_with_their_cause(install: Install, capsys: pytest.CaptureFixture[str]) -> None:
    install("broken", {"machines": {name: value for name, (value, _) in MACHINES.items()}})
    assert main(["machines", "--json"]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)["machines"]}
    assert rows["hexapod"]["problem"] is None
    assert all(cause in rows[name]["problem"] for name, (_, cause) in MACHINES.items())
    with pytest.raises(prs.PluginError, match="machine 'module'"):
        prs.load_machine("module")


def test_a_machine_package_needs_no_init(install: Install, tmp_path: Path) -> None:
    (tmp_path / "plain" / "machine").mkdir(parents=True)
    install("plain", {"machines": {"plain": "plain.machine"}})
    assert plugins.machine_folder("plain") == tmp_path / "plain" / "machine"


def test_a_task_is_a_task(install: Install) -> None:
    install("broken", {"tasks": {"juggle": "elsewhere:Angry"}})
    with pytest.raises(prs.PluginError, match=r"task 'juggle' .*expected a subclass of prs_model\.Task"):
        plugins.task("juggle")
    assert issubclass(plugins.task("xyz"), prs.Task)


def test_one_name_from_two_distributions(install: Install, caplog: pytest.LogCaptureFixture) -> None:
    """The first on the path counts; the same plug-in found a second time is no matter."""
    install("other", {"reducers": {"solid": "elsewhere:Angry", "rigid": "prs_reducers.rigid:RigidReducer"}})
    with caplog.at_level(logging.WARNING, "prs_model"), pytest.raises(prs.PluginError, match="no licence"):
        plugins.reducer("solid")
    assert [record.getMessage() for record in caplog.records] == [
        "reducer 'solid' is installed twice: elsewhere:Angry of other is used, "
        "prs_reducers.solid:SolidReducer of prs-model is not"
    ]


def test_a_description_that_names_a_broken_plugin_says_where(install: Install) -> None:
    install("broken", {"reducers": {"angry": "elsewhere:Angry"}, "tasks": {"juggle": "elsewhere:number"}})
    changes = {"bodies.platform.reducer": "angry", "task.kind": "juggle"}
    hexapod = prs.load_machine("hexapod")
    with pytest.raises(prs.DescriptionError) as caught:
        hexapod.replace(changes)
    messages = {problem.entry: problem.message for problem in caught.value.problems}
    assert messages["bodies.platform.reducer"] == (
        "reducer 'angry' (installed as elsewhere:Angry) cannot be used: OSError: no licence"
    )
    assert messages["task.kind"].startswith("task 'juggle' (installed as elsewhere:number) cannot be used: found 3")
