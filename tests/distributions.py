"""Distributions built and installed as a user's are."""

import os
import subprocess
import sys
from pathlib import Path


def run(*command: str | Path, cwd: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Run a command that sees nothing of the checkout: what PYTHONPATH adds would hide what is not installed."""
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONPATH"}
    words = [str(word) for word in command]
    return subprocess.run(words, cwd=cwd, capture_output=True, text=True, check=False, env=environment)


def build(project: Path, out: Path) -> Path:
    """The wheel of a project, made from its sdist."""
    done = run(sys.executable, "-m", "build", "--no-isolation", "--outdir", out, project)
    assert done.returncode == 0, done.stdout + done.stderr
    return next(out.glob("*.whl"))


def install(scripts: Path, wheel: Path) -> None:
    """Install a wheel, and nothing else, into the environment with these scripts."""
    done = run(scripts / "python", "-m", "pip", "install", "--quiet", "--no-deps", "--no-index", wheel)
    assert done.returncode == 0, done.stderr
