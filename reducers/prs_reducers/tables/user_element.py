"""Files of linear user elements: what Abaqus and CalculiX call substructures, which are not the same thing."""

from __future__ import annotations

import re

HEAD = re.compile(r"^\*USER ELEMENT\b[^\n]*?NODES\s*=\s*(\d+)([^\n]*)$", re.IGNORECASE | re.MULTILINE)
"""The first line of an element: its number of nodes, and the parameters after it."""

OF_CALCULIX = (
    "output of *SUBSTRUCTURE GENERATE: CalculiX (2.20 at least) writes the stiffness of the retained nodes with all "
    "others held there, not the condensed one, and no mass; use *FREQUENCY, SOLVER=MATRIXSTORAGE instead and name "
    "the .sti file that it writes"
)


def is_user_element(text: str) -> bool:
    """Whether the text of a file is one."""
    return HEAD.search(text[:100_000]) is not None
