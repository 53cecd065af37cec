"""Unit systems and their factors to SI."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi
from typing import Literal, get_args

from pydantic import BaseModel, ConfigDict

LengthUnit = Literal["m", "cm", "mm", "um", "in", "ft"]
ForceUnit = Literal["N", "kN", "mN", "lbf"]
MassUnit = Literal["kg", "g", "tonne", "lb", "slinch"]
AngleUnit = Literal["rad", "deg"]

_TO_SI: dict[str, float] = {
    "m": 1.0,
    "cm": 1e-2,
    "mm": 1e-3,
    "um": 1e-6,
    "in": 0.0254,
    "ft": 0.3048,
    "N": 1.0,
    "kN": 1e3,
    "mN": 1e-3,
    "lbf": 4.4482216152605,
    "kg": 1.0,
    "g": 1e-3,
    "tonne": 1e3,
    "lb": 0.45359237,
    "slinch": 175.126835246476,  # lbf s^2/in
    "rad": 1.0,
    "deg": pi / 180.0,
}


class Units(BaseModel):
    """The units in which a file's numbers are written; time is always in seconds."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    length: LengthUnit = "m"
    force: ForceUnit = "N"
    mass: MassUnit = "kg"
    angle: AngleUnit = "rad"

    @classmethod
    def parse(cls, text: str) -> Units:
        """Read a consistent system such as ``mm-N-tonne-s``.

        Raises ValueError naming the known units when a word is not one of them, or when force is not
        mass times length per second squared (a finite-element file has no room for two scales).
        """
        words = text.split("-")
        kinds = (LengthUnit, ForceUnit, MassUnit)
        if len(words) != 4 or words[3] != "s":
            raise ValueError(f"found '{text}', expected length-force-mass-time such as 'mm-N-tonne-s' or 'm-N-kg-s'")
        for word, kind in zip(words, kinds, strict=False):
            if word not in get_args(kind):
                raise ValueError(f"found unit '{word}' in '{text}', expected one of {', '.join(get_args(kind))}")
        units = cls.model_validate(dict(zip(("length", "force", "mass"), words, strict=False)))
        ratio = Dimension(force=1, mass=-1, length=-1).factor(units)
        if abs(ratio - 1.0) > 1e-6:
            raise ValueError(
                f"'{text}' is not consistent: 1 {units.force} is {1 / ratio:g} times "
                f"1 {units.mass} x {units.length}/s^2; use for example 'mm-N-tonne-s' or 'm-N-kg-s'"
            )
        return units


SI = Units()


@dataclass(frozen=True)
class Dimension:
    """Exponents of the base quantities of a number."""

    length: int = 0
    force: int = 0
    mass: int = 0
    angle: int = 0
    time: int = 0  # always in seconds

    def factor(self, units: Units) -> float:
        """What a number in `units` is multiplied with to become SI."""
        return (
            _TO_SI[units.length] ** self.length
            * _TO_SI[units.force] ** self.force
            * _TO_SI[units.mass] ** self.mass
            * _TO_SI[units.angle] ** self.angle
        )

    def label(self, units: Units) -> str:
        """The unit in words, such as ``N/mm``."""
        parts = [
            (units.force, self.force),
            (units.mass, self.mass),
            (units.length, self.length),
            (units.angle, self.angle),
            ("s", self.time),
        ]
        above = "*".join(unit if n == 1 else f"{unit}^{n}" for unit, n in parts if n > 0)
        below = "/".join(unit if n == -1 else f"{unit}^{-n}" for unit, n in parts if n < 0)
        return (above or "1") + (f"/{below}" if below else "") if above or below else "a plain number"
