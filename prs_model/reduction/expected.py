"""What is known of a part beforehand, against what was read: the one check that sees a wrong unit or a wrong file."""

from __future__ import annotations

from ..description.schema import Expected
from ..errors import PartFileError
from ..readable import figure
from .store import Element
from .super_element import SuperElement

TOLERANCE = 0.05  # relative: a rigid interface stiffens a part by some percent
DIGITS = 6


def check_expected(element: Element, expected: Expected) -> None:
    """Raises PartFileError for a mass [kg] or first frequency [Hz] that is not the expected one, naming the file."""
    first = element if isinstance(element, SuperElement) else element.elements[0]
    if expected.mass is not None:
        if first.grounded:
            raise PartFileError(_place(first), "expected.mass: a part that is held to the ground shows none; remove it")
        _compare(first, expected, "mass", "kg", float(expected.mass), first.mass_properties().mass)
    if expected.frequency is not None:
        found = first.frequencies(1)
        value = float(found[0]) if found.size else None
        _compare(first, expected, "frequency", "Hz", float(expected.frequency), value)


def _compare(
    element: SuperElement, expected: Expected, what: str, unit: str, wanted: float, found: float | None
) -> None:
    tolerance = TOLERANCE if expected.tolerance is None else float(expected.tolerance)
    if found is not None and abs(found / wanted - 1.0) <= tolerance:
        return
    read = "none" if found is None else f"{figure(found, DIGITS)} {unit}"
    within = f"{figure(wanted, DIGITS)} {unit} within {100.0 * tolerance:.3g} %"
    check = "check 'units', that the file is this part's, and whether more modes or averaged interfaces bring it near"
    raise PartFileError(_place(element), f"expected.{what}: found {read}, expected {within}; {check}")


def _place(element: SuperElement) -> str:
    return element.provenance.get("source") or element.name
