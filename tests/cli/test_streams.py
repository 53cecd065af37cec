"""What goes to which descriptor, in processes of their own: pytest's capture stands in for none of it."""

import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

GANTRY = Path(__file__).parents[1] / "description" / "small_machine"

needs_dev_full = pytest.mark.skipif(not Path("/dev/full").exists(), reason="no /dev/full on this system")

NOISY = """
import ctypes, os, sys
from prs_model.cli import machines, main

def noisy(folder, quiet=machines.load_description):
    print("from Python")
    os.write(1, b"straight to the descriptor\\n")
    ctypes.CDLL(None).printf(b"from C, kept until the end\\n")
    return quiet(folder)

machines.load_description = noisy
status = main(["machines", "--json"])
print("after the command", file=sys.__stdout__)
sys.exit(status)
"""


def shell(command: str, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run `prs-model` with redirections."""
    line = f'"{sys.executable}" -m prs_model {command}'
    return subprocess.run(
        line, shell=True, capture_output=True, text=True, check=False, env={**os.environ, **environment}
    )


def is_one_sentence(text: str) -> bool:
    return text.startswith("prs-model: ") and len(text.splitlines()) == 1 and "internal error" not in text


def test_json_is_alone_on_standard_output_whoever_prints() -> None:
    buffered = {name: value for name, value in os.environ.items() if name != "PYTHONUNBUFFERED"}
    done = subprocess.run([sys.executable, "-c", NOISY], capture_output=True, text=True, check=False, env=buffered)
    assert done.returncode == 0, done.stderr
    assert {row["name"] for row in json.loads(done.stdout)["machines"]} >= {"head_3prs", "hexapod"}
    for noise in ("from Python", "straight to", "kept until the end", "after the command"):
        assert noise in done.stderr


@needs_dev_full
@pytest.mark.parametrize("option", ["", "--json"])
def test_a_full_disk(option: str) -> None:
    done = shell(f"machines {option} >/dev/full")
    assert done.returncode == 1
    assert is_one_sentence(done.stderr)
    assert "the result cannot be printed: No space left on device" in done.stderr


def test_closed_streams() -> None:
    lost = shell("machines >&-")
    assert lost.returncode == 1
    assert "standard output is closed" in lost.stderr
    silent = shell("modes hexapot 2>&-")
    assert (silent.returncode, silent.stdout) == (1, "")
    assert "machines" in json.loads(shell("machines --json 2>&-").stdout)


def test_a_reader_that_leaves() -> None:
    done = shell("machines | true")
    assert "Traceback" not in done.stderr
    assert "BrokenPipe" not in done.stderr


def test_a_stream_that_cannot_encode_a_title(tmp_path: Path) -> None:
    shutil.copytree(GANTRY, tmp_path, dirs_exist_ok=True)
    machine = tmp_path / "machine.yaml"
    machine.write_text(machine.read_text().replace("title: Gantry", "title: Größe"), encoding="utf-8")
    done = shell(f'validate "{tmp_path}"', PYTHONIOENCODING="ascii")
    assert done.returncode == 0, done.stderr
    assert "Gr\\xf6\\xdfe" in done.stdout


def test_a_backend_that_matplotlib_does_not_know(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    done = shell(f'modes hexapod --picture "{tmp_path / "modes.png"}"', MPLBACKEND="none_such")
    assert done.returncode == 1
    assert is_one_sentence(done.stderr)
    assert "matplotlib cannot be used: Key backend: 'none_such'" in done.stderr
