"""Two reports, made once: one with surfaces, one without, the latter at two poses."""

from pathlib import Path

import pytest

import prs_model as prs


@pytest.fixture(scope="session")
def head(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a report on head_3prs."""
    return _made(tmp_path_factory, "head_3prs", [{}], None)


@pytest.fixture(scope="session")
def hexapod(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a report on hexapod, whose second pose is outside its workspace, with a map."""
    return _made(tmp_path_factory, "hexapod", [{}, {"z": 0.0935}], 0.02)


def _made(factory: pytest.TempPathFactory, name: str, poses: list[dict[str, float]], damping: float | None) -> Path:
    for package in ("matplotlib", "jinja2"):
        pytest.importorskip(package)
    folder = factory.mktemp("report") / name
    files = prs.write_report(prs.load_machine(name), folder, poses, damping=damping, with_map=name == "hexapod")
    assert files[0] == folder / "report.html"
    assert {*files} == {path for path in folder.rglob("*") if path.is_file()}
    return folder
