"""A verification on disk: its data, its tables as a page, its pictures."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from ..errors import PrsError
from ..reduction.storage import whole
from .pictures import Picture, draw
from .plain import as_dict
from .report import VerificationReport
from .tables import Table, tables


def write_all(reports: Sequence[VerificationReport], folder: Path, command: str = "") -> tuple[Path, ...]:
    """Write results.json, results.md and the pictures of the first report into a folder, which is made if need be.

    command: what made them, for the page. Returns the files. Raises PrsError or MissingExtraError.
    """
    check_folder(folder)
    drawn = draw(reports[0], folder)
    texts = {
        "results.json": json.dumps([as_dict(report) for report in reports], indent=1, allow_nan=False) + "\n",
        "results.md": page(reports, drawn, command),
    }
    for name, text in texts.items():
        with whole(folder / name) as file:
            file.write(text.encode())
    return (*(folder / name for name in texts), *(folder / name for each in drawn for name in each.files))


def check_folder(folder: Path) -> None:
    """Make the folder. Raises PrsError when it cannot be made."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise PrsError(f"{folder}: cannot be made ({error.strerror}); expected a folder to write to") from error


def page(reports: Sequence[VerificationReport], pictures: Sequence[Picture] = (), command: str = "") -> str:
    """All tables in Markdown, with the pictures of the first report after its own."""
    first = reports[0]
    lines = [f"# {first.title or first.machine}: verification", ""]
    lines += [f"Made by `{command}`. Do not edit.", ""] if command else []
    for report in reports:
        lines += [f"## {stiffness_text(report)}", ""] if len(reports) > 1 else []
        lines += [markdown(each) for each in tables(report)]
        if report is first:
            lines += [f"![{each.caption}]({each.files[0]})\n\n{each.caption}\n" for each in pictures]
    return "\n".join(lines)


def stiffness_text(report: VerificationReport) -> str:
    """Which joints the report is about."""
    factor = report.joint_stiffness
    return "Joints as described" if factor == 1.0 else f"Stiffness of all joints times {factor:g}"


def markdown(table: Table) -> str:
    """A table under its heading, with its note."""
    rows = (table.header, tuple("---" for _ in table.header), *table.rows)
    body = "\n".join(f"| {' | '.join(row)} |" for row in rows)
    return "\n".join([f"### {table.heading}", "", body, "", *([table.note, ""] if table.note else [])])
