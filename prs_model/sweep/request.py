"""What is asked of every pose of a sweep."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import isfinite
from numbers import Integral, Real
from types import MappingProxyType

from ..errors import PrsError, UnknownNameError

QUANTITIES: Mapping[str, str] = MappingProxyType(
    {
        "frequency": "natural frequencies",
        "static_compliance": "compliance at rest of the end-reference point",
        "flexibility_share": "share of each mode in the end-reference point's compliance along and about every axis",
        "kinetic_energy": "share of each body in each mode's kinetic energy",
        "strain_energy": "share of each body and joint in each mode's strain energy",
        "frf_peak": "largest receptance of the end-reference point along u, v, w in a band, and where it is",
        "identity": "which mode a frequency belongs to, followed through crossings",
    }
)
"""What a sweep can be asked for, in words; frequencies always come along."""

_TOLERANCES = (1e-12, 1e-2)


@dataclass(frozen=True)
class Request:
    """What is asked of every pose. Raises PrsError or UnknownNameError for what cannot be meant.

    quantities: of QUANTITIES, kept in that order, frequency among them. tolerance: relative, of every frequency.
    band: in which resonance peaks are sought [Hz].
    """

    n_modes: int = 6
    quantities: tuple[str, ...] = ("frequency",)
    tolerance: float = 1e-6
    band: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "quantities", _in_order(self.quantities))
        if not isinstance(self.n_modes, Integral) or isinstance(self.n_modes, bool) or self.n_modes < 1:
            raise PrsError(f"n_modes: found {self.n_modes!r}, expected a whole number above zero")
        low, high = _TOLERANCES
        if not _is_number(self.tolerance) or not low <= self.tolerance <= high:
            raise PrsError(f"tolerance: found {self.tolerance!r}, expected a number between {low:g} and {high:g}")
        object.__setattr__(self, "n_modes", int(self.n_modes))
        object.__setattr__(self, "tolerance", float(self.tolerance))
        if self.band is not None:
            object.__setattr__(self, "band", _band(self.band))
        if self.band is None and "frf_peak" in self.quantities:
            raise PrsError("band: found none, expected (lowest, highest) in Hz, in which frf_peak is sought")


def _in_order(quantities: object) -> tuple[str, ...]:
    names = (quantities,) if isinstance(quantities, str) else quantities
    if not isinstance(names, tuple | list | set | frozenset):
        raise PrsError(f"quantities: found {quantities!r:.60}, expected names of: {', '.join(QUANTITIES)}")
    for name in names:
        if name not in QUANTITIES:
            raise UnknownNameError("quantity", str(name), list(QUANTITIES))
    return tuple(name for name in QUANTITIES if name in names or name == "frequency")


def _band(band: object) -> tuple[float, float]:
    pair = tuple(band) if isinstance(band, tuple | list) else ()
    if len(pair) != 2 or not all(map(_is_number, pair)) or not 0.0 < pair[0] < pair[1]:
        raise PrsError(f"band: found {band!r:.60}, expected (lowest, highest) in Hz, the lowest above zero")
    return float(pair[0]), float(pair[1])


def _is_number(value: object) -> bool:
    return isinstance(value, Real) and not isinstance(value, bool) and isfinite(value)
