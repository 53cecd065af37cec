"""``prs-model explore`` as a user meets it."""

import json
import os
import re
import signal
import socket
import subprocess
import sys
from urllib.request import urlopen

import pytest

from tests.cli.test_cli import run


@pytest.mark.skipif(os.name == "nt", reason="Ctrl-C is a signal elsewhere")
def test_the_page_answers_until_ctrl_c_and_the_result_is_one_json_object() -> None:
    pytest.importorskip("viser")
    command = [sys.executable, "-m", "prs_model", "explore", "hexapod", "--port", "0", "--json", "--quiet"]
    heard = {"preexec_fn": lambda: signal.signal(signal.SIGINT, signal.SIG_DFL)}  # shells mute it for background jobs
    with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, **heard) as process:
        try:
            address = _address(process)
            with urlopen(address, timeout=30) as page:
                assert b"<html" in page.read()
            process.send_signal(signal.SIGINT)
            out, err = process.communicate(timeout=30)
        finally:
            process.kill()
    assert process.returncode == 0
    assert json.loads(out)["solved"] == 1
    assert "Traceback" not in err


def _address(process: subprocess.Popen[str]) -> str:
    """From the messages, which end when the process does."""
    assert process.stderr is not None
    for line in process.stderr:
        if found := re.search(r"http://127\.0\.0\.1:\d+", line):
            return found[0]
    raise AssertionError("no address was given")


def test_a_port_in_use_is_one_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("viser")
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        status, out, err = run(capsys, "explore", "hexapod", "--port", str(port))
    assert (status, out, len(err.splitlines())) == (1, "", 1)
    assert f"port {port} of 127.0.0.1 cannot be had (Address already in use)" in err


def test_without_viser_the_extra_is_named(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "viser", None)
    status, out, err = run(capsys, "explore", "hexapod")
    assert (status, out) == (1, "")
    assert err.strip().endswith(
        "exploring a machine needs the package 'viser': install it with pip install 'prs-model[viz]'"
    )
