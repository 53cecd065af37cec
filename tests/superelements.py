"""Real exports to check readers with, kept outside of the project: tests skip where they are not there."""

import json
import os
from pathlib import Path
from typing import Any

import pytest

DATA = Path(os.environ.get("PRS_SUPERELEMENTS", Path(__file__).parents[2] / "shared" / "data" / "superelements"))

needs_data = pytest.mark.skipif(
    not (DATA / "reference.json").is_file(), reason=f"the real exports are not in {DATA} (or PRS_SUPERELEMENTS)"
)


def reference(record: str) -> dict[str, Any]:
    """One record of reference.json, such as ``calculix/full_free``."""
    return dict(json.loads((DATA / "reference.json").read_text())[record])
