"""What a map shows: panels of values over the poses, one for each mode or direction."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from ...arrays import FloatArray

if TYPE_CHECKING:
    import xarray

DRAWABLE: Mapping[str, str] = MappingProxyType(
    {
        "frequency": "frequency",
        "tracked_frequency": "identity",
        "identity": "identity",
        "static_compliance": "static_compliance",
        "frf_peak": "frf_peak",
        "frf_peak_frequency": "frf_peak",
    }
)
"""What can be drawn, and the quantity it comes with."""


_ALIKE = 1e-9  # relative: poses that symmetry makes alike, parted by rounding only


def extreme(values: FloatArray, sign: int) -> tuple[int, ...]:
    """The place of the lowest (sign -1) or largest value (1); the first of those that are alike."""
    signed = -sign * values
    best = np.nanmin(signed)
    flat = np.flatnonzero(signed <= best + _ALIKE * abs(best))[0]
    return tuple(int(k) for k in np.unravel_index(flat, values.shape))


@dataclass(frozen=True, eq=False)
class Panel:
    """One map: values over the poses, their unit, and which end is the worst: -1 the lowest, 1 the largest, 0 none.

    modes: how many there are, where the values are their numbers.
    """

    title: str
    values: FloatArray
    unit: str
    worst: int
    modes: int = 0

    def worst_place(self) -> tuple[int, ...]:
        return extreme(self.values, self.worst)

    def value_text(self) -> str:
        return f"{self.values[self.worst_place()]:.5g} {self.unit}"

    def transposed(self) -> Panel:
        return replace(self, values=self.values.T)

    def closed(self) -> Panel:
        """With the first column once more at the end."""
        return replace(self, values=np.column_stack([self.values, self.values[:, :1]]))


def panels_of(data: xarray.Dataset, quantity: str) -> list[Panel]:
    """One for each mode; of a compliance, for each direction."""
    variable = data[quantity].transpose(*data["reason"].dims, ...)
    values = np.asarray(variable.values, dtype=float)
    if quantity == "static_compliance":
        units = map(str, np.diag(data["static_compliance_unit"].values))
        names = [f"compliance {name}" for name in data["response"].values]
        return [
            _scaled(name, values[..., k, k], unit, 1) for k, (name, unit) in enumerate(zip(names, units, strict=True))
        ]
    last = str(variable.dims[-1])
    word, unit = "receptance along" if last == "axis" else "mode", str(variable.attrs.get("units", "1"))
    characters = variable.coords.get("character")
    if quantity == "identity":
        values = np.where(values > 0.0, values, np.nan)
        return [Panel(f"mode {k + 1}", values[..., k], "mode", 0, values.shape[-1]) for k in range(values.shape[-1])]
    return [
        _scaled(
            f"{word} {name}" + ("" if characters is None else f": {characters.values[k]}"),
            values[..., k],
            unit,
            1 if quantity == "frf_peak" else -1,
        )
        for k, name in enumerate(data[last].values)
    ]


def _scaled(title: str, values: FloatArray, unit: str, worst: int) -> Panel:
    """Compliances per million, so that their numbers are short."""
    factor = 1e6 if unit.endswith(("/N", "/(N m)")) else 1.0
    return Panel(title, factor * values, unit if factor == 1.0 else f"u{unit}", worst)
