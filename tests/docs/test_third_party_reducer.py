"""The example of write-a-reducer.md is a distribution of its own: built, installed and tested as its author would."""

import json
import re
import shutil
from pathlib import Path

import pytest

from tests.distributions import build, install, run

DOCS = Path(__file__).parents[2] / "docs"
EXAMPLE = DOCS / "examples" / "third_party_reducer"

REDUCE = """
import prs_model as prs
element = prs.reduce("lab_text", "bar.lab", nodes={"base": "left", "tip": "right"}, units="mm-N-tonne-s")
print(element.mass_properties().mass)
"""


@pytest.fixture(scope="module")
def project(environment: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A copy of the example, installed."""
    folder = tmp_path_factory.mktemp("third_party") / "project"
    shutil.copytree(EXAMPLE, folder, ignore=shutil.ignore_patterns("__pycache__"))
    install(environment, build(folder, folder.parent / "dist"))
    return folder


def test_it_passes_the_conformance_kit(environment: Path, project: Path) -> None:
    words = ["-m", "pytest", "-q", "-p", "no:cacheprovider", "--import-mode=importlib", "tests"]
    done = run(environment / "python", *words, cwd=project)
    assert done.returncode == 0, done.stdout + done.stderr
    assert int(re.findall(r"(\d+) passed", done.stdout)[0]) >= 12


def test_it_is_listed_and_reads_its_part(environment: Path, project: Path) -> None:
    listed = json.loads(run(environment / "prs-model", "reducers", "--json", cwd=project).stdout)["reducers"]
    assert {row["name"]: row["problem"] for row in listed}["lab_text"] is None
    done = run(environment / "python", "-c", REDUCE, cwd=project / "tests")
    assert done.returncode == 0, done.stderr
    assert float(done.stdout) == pytest.approx(7850.0 * 0.3 * 0.03 * 0.02)


def test_the_commands_of_the_page(environment: Path, project: Path) -> None:
    """Its last block, line by line; words of interfaces are nodes of this part, which has no sets."""
    page = (DOCS / "write-a-reducer.md").read_text()
    commands = re.findall(r"\n\n```\n(prs-model .*?)```", page, re.DOTALL)[-1].splitlines()
    assert [line.split()[:2] for line in commands] == [["prs-model", "reducers"], ["prs-model", "reduce"]]
    for line in commands:
        program, *words = line.split()
        done = run(environment / program, *words, cwd=project)
        assert done.returncode == 0, done.stderr
    assert re.search(r"^mass/kg +1\.413$", done.stdout, re.MULTILINE)
    refused = run(environment / "prs-model", *words, "--interface", "more=lift", cwd=project)
    assert refused.returncode == 1
    assert "found 'lift', " in refused.stderr


def test_the_sample_is_what_its_script_writes(environment: Path, project: Path) -> None:
    part = project / "tests" / "bar.lab"
    before = [float(word) for word in part.read_text().split() if len(word) > 15]
    assert run(environment / "python", part.with_name("make_bar.py")).returncode == 0
    after = [float(word) for word in part.read_text().split() if len(word) > 15]
    assert after == pytest.approx(before, rel=1e-12, abs=1e-6)


def test_the_page_shows_the_code_that_is_tested() -> None:
    """Every block of the page that names a file of the example is a piece of it, word for word."""
    blocks = re.findall(r"`([\w./]+)`[^\n]*:\n\n```\w+\n(.*?)```", (DOCS / "write-a-reducer.md").read_text(), re.DOTALL)
    assert {name for name, _ in blocks} >= {"prs_lab_text/__init__.py", "pyproject.toml", "tests/test_lab_text.py"}
    for name, block in blocks:
        assert block in (EXAMPLE / name).read_text(), f"{name} has no such piece:\n{block}"
