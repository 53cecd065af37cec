"""For authors of reducers: the conformance kit and the damage table, which our own reducers run as well."""

from .conformance import Check, conformance
from .damage import Outcome, as_text, damage_table
from .sample import Sample

__all__ = ["Check", "Outcome", "Sample", "as_text", "conformance", "damage_table"]
