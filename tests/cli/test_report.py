"""``prs-model report`` as a user meets it."""

import json
from pathlib import Path

import pytest

from tests.cli.test_cli import run


def test_report_says_where_it_is(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    for package in ("matplotlib", "jinja2"):
        pytest.importorskip(package)
    folder = tmp_path / "deep" / "report"
    arguments = ("-n", "2", "--damping", "0.03", "--pose", "z=89mm", "--pose", "z=91mm", "rx=1deg", "--json")
    status, out, _ = run(capsys, "report", "hexapod", "-o", str(folder), *arguments)
    outcome = json.loads(out)
    assert status == 0
    assert outcome["page"] == str(folder / "report.html")
    assert all(Path(file).is_file() for file in outcome["files"])
    page = Path(outcome["page"]).read_text(encoding="utf-8")
    assert "z 91 mm, rx 1 deg" in page
    assert "mode 3" not in page


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--damping", "1.5"], "damping.modal: found 1.5, expected a ratio below 1, such as 0.025\n"),
        (["--damping", "2.5%"], "--damping: found '2.5%', expected a ratio such as 0.025"),
        (["--pose", "z=1deg"], "--pose z: found unit 'deg'"),
        (["--pose", "z=9m"], "z 9000 mm"),
        (["--set", "joints.Q.rigid=true"], "Q"),
    ],
)
def test_wrong_input(capsys: pytest.CaptureFixture[str], arguments: list[str], words: str, tmp_path: Path) -> None:
    status, out, err = run(capsys, "report", "hexapod", "-o", str(tmp_path / "report"), *arguments)
    assert (status, out) == (1, "")
    assert words in err
    assert "Traceback" not in err


def test_folder_that_cannot_be_made(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")
    status, out, err = run(capsys, "report", "hexapod", "-o", str(tmp_path / "file" / "report"))
    assert (status, out) == (1, "")
    assert len(err.splitlines()) == 1
    assert "cannot be made" in err


def test_page_that_is_a_folder(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "report.html").mkdir()
    status, _, err = run(capsys, "report", "hexapod", "-o", str(tmp_path))
    assert status == 1
    assert "report.html: found a folder, where the report has a file" in err
