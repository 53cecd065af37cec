"""The project as a user installs it, once for all tests that ask for it."""

import sys
from pathlib import Path

import pytest

from tests.distributions import build, install, run


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
