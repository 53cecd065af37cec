"""What tests of several folders ask for: the project as a user installs it, and a browser."""

import os
import sys
from collections.abc import Generator
from pathlib import Path

import pytest

from tests.browser import browser, opened
from tests.distributions import build, install, run

__all__ = ["browser", "environment", "opened", "wheel"]


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """With PRS_REQUIRE_BROWSER set, a page that was not looked at is a failure: no check passes by doing nothing."""
    report = yield
    if report.skipped and item.get_closest_marker("browser") and os.environ.get("PRS_REQUIRE_BROWSER"):
        report.outcome = "failed"
        report.longrepr = f"skipped, though PRS_REQUIRE_BROWSER is set: {report.longreprtext}"
    return report


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel of this project."""
    pytest.importorskip("build", reason="the package `build` makes the distributions")
    pytest.importorskip("hatchling", reason="the build backend")
    return build(Path(__file__).parents[1], tmp_path_factory.mktemp("dist"))


@pytest.fixture(scope="session")
def environment(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The scripts' folder of an environment with the wheel in it; its dependencies are those of the running one."""
    folder = tmp_path_factory.mktemp("environment")
    assert run(sys.executable, "-m", "venv", folder).returncode == 0
    scripts = folder / "bin"
    install(scripts, wheel)
    site = Path(run(scripts / "python", "-c", "import sysconfig; print(sysconfig.get_path('purelib'))").stdout.strip())
    (site / "dependencies.pth").write_text("\n".join(path for path in sys.path if "site-packages" in path) + "\n")
    return scripts
