"""Reading and checking machine.yaml and the URDF beside it."""

from __future__ import annotations

from typing import Any

from .load import MachineDescription, load_description
from .replace import replaced
from .schema import MachineFile
from .yaml_loader import parse_value

__all__ = ["MachineDescription", "json_schema", "load_description", "parse_value", "replaced"]


def json_schema() -> dict[str, Any]:
    """The JSON schema of machine.yaml, for editors that complete and check YAML."""
    schema = MachineFile.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema, "title": "machine.yaml of prs-model"}
