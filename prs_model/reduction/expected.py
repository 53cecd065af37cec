"""What is known of a part beforehand, against what was read: the one check that sees a wrong unit or a wrong file."""

from __future__ import annotations

from ..description.schema import Expected
from ..errors import PhysicsError, PrsError
from .store import Element
from .summary import summarize
from .super_element import SuperElement

TOLERANCE = 0.05  # relative: a rigid interface stiffens a part by some percent


def check_expected(element: Element, expected: Expected) -> None:
    """Raises PhysicsError for a mass [kg] or first frequency [Hz] that is not the expected one."""
    first = element if isinstance(element, SuperElement) else element.elements[0]
    summary, tolerance = summarize(first, 1), TOLERANCE if expected.tolerance is None else expected.tolerance
    if expected.mass is not None and summary.properties is None:
        raise PrsError(f"{first.name}: expected.mass: a part that is held to the ground shows no mass; remove it")
    mass = None if summary.properties is None else summary.properties.mass
    frequency = float(summary.free[0]) if summary.free.size else None
    for what, unit, wanted, found in (
        ("mass", "kg", expected.mass, mass),
        ("first frequency", "Hz", expected.frequency, frequency),
    ):
        if wanted is None:
            continue
        off = float("inf") if found is None else abs(found / wanted - 1.0)
        if off > tolerance:
            read = "none" if found is None else f"{found:.6g} {unit}"
            cause = f"read {read}; check 'units', and that the file is this part's"
            raise PhysicsError(first.name, f"{what} is {wanted:.6g} {unit} as expected", off, tolerance, cause)
