"""Numbers with a unit dimension and a source, as pydantic field types."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Annotated, Any, Literal, get_args

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler
from pydantic.json_schema import JsonSchemaValue
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from .units import SI, Dimension, Units

LARGEST = 1e100  # beyond any machine; products of such numbers stay finite

Source = Literal["measured", "catalogue", "paper", "assumed", "computed", "fitted"]


class Quantity(float):
    """A number in SI that remembers where it came from."""

    source: Source | None
    note: str | None

    def __new__(cls, value: float, source: Source | None = None, note: str | None = None) -> Quantity:
        self = super().__new__(cls, value)
        self.source = source
        self.note = note
        return self


@dataclass(frozen=True)
class _Field:
    """Validates a plain number or ``{value, source, note}`` and converts it from the file's units to SI."""

    dimension: Dimension
    positive: bool = False
    non_negative: bool = False
    below: float | None = None  # for plain ratios
    rigid: bool = False  # the word 'rigid' is read as infinity

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        return core_schema.with_info_plain_validator_function(self._validate)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> JsonSchemaValue:
        number: dict[str, Any] = {"type": "number"}
        if self.positive:
            number["exclusiveMinimum"] = 0
        if self.non_negative:
            number["minimum"] = 0
        if self.below is not None:
            number["exclusiveMaximum"] = self.below
        if self.rigid:
            number = {"anyOf": [number, {"const": "rigid"}]}
        with_source = {
            "type": "object",
            "properties": {
                "value": number,
                "source": {"enum": list(get_args(Source))},
                "note": {"type": "string"},
            },
            "required": ["value"],
            "additionalProperties": False,
        }
        return {"anyOf": [number, with_source]}

    def _validate(self, raw: Any, info: core_schema.ValidationInfo) -> Quantity:
        units: Units = (info.context or {}).get("units", SI)
        unit = self.dimension.label(units)
        if isinstance(raw, Quantity):
            return raw
        value, source, note = _unpack(raw, unit)
        if self.rigid and value == "rigid":
            return Quantity(math.inf, source, note)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise PydanticCustomError("number", f"found {value!r}, expected a number ({unit})")
        if not abs(value) < LARGEST:
            found = value if isinstance(value, float) else "a very long number"
            raise PydanticCustomError("finite", f"found {found}, expected a finite number ({unit})")
        if self.positive and value <= 0:
            raise PydanticCustomError("positive", f"found {value:g}, expected a number above zero ({unit})")
        if self.non_negative and value < 0:
            raise PydanticCustomError("non_negative", f"found {value:g}, expected zero or more ({unit})")
        if self.below is not None and value >= self.below:
            raise PydanticCustomError("below", f"found {value:g}, expected a ratio below {self.below:g}, such as 0.025")
        return Quantity(value * self.dimension.factor(units), source, note)


def _unpack(raw: Any, unit: str) -> tuple[Any, Source | None, str | None]:
    if not isinstance(raw, dict):
        return raw, None, None
    unknown = set(raw) - {"value", "source", "note"}
    if unknown or "value" not in raw:
        raise PydanticCustomError(
            "number", f"found keys {sorted(map(str, raw))}, expected a number ({unit}) or value, source, note"
        )
    source = raw.get("source")
    if source is not None and source not in get_args(Source):
        raise PydanticCustomError("source", f"found source '{source}', expected one of {', '.join(get_args(Source))}")
    note = raw.get("note")
    if note is not None and not isinstance(note, str):
        raise PydanticCustomError("note", f"found the note {note!r}, expected text; put it in quotes")
    return raw["value"], source, note


Number = Annotated[Quantity, _Field(Dimension())]
DampingRatio = Annotated[Quantity, _Field(Dimension(), non_negative=True, below=1.0)]
LossFactor = Annotated[Quantity, _Field(Dimension(), non_negative=True, below=2.0)]
Tolerance = Annotated[Quantity, _Field(Dimension(), non_negative=True, below=1.0)]
Frequency = Annotated[Quantity, _Field(Dimension(time=-1), positive=True)]
Rate = Annotated[Quantity, _Field(Dimension(time=-1), non_negative=True)]
Duration = Annotated[Quantity, _Field(Dimension(time=1), non_negative=True)]
Length = Annotated[Quantity, _Field(Dimension(length=1))]
PositiveLength = Annotated[Quantity, _Field(Dimension(length=1), positive=True)]
PositiveNumber = Annotated[Quantity, _Field(Dimension(), positive=True)]
Area = Annotated[Quantity, _Field(Dimension(length=2), positive=True)]
AreaMoment = Annotated[Quantity, _Field(Dimension(length=4), positive=True)]
Mass = Annotated[Quantity, _Field(Dimension(mass=1), positive=True)]
Inertia = Annotated[Quantity, _Field(Dimension(mass=1, length=2))]
Density = Annotated[Quantity, _Field(Dimension(mass=1, length=-3), positive=True)]
Pressure = Annotated[Quantity, _Field(Dimension(force=1, length=-2), positive=True)]
Force = Annotated[Quantity, _Field(Dimension(force=1), positive=True)]
Stiffness = Annotated[Quantity, _Field(Dimension(force=1, length=-1), positive=True, rigid=True)]
RotationalStiffness = Annotated[Quantity, _Field(Dimension(force=1, length=1), positive=True, rigid=True)]
Compliance = Annotated[Quantity, _Field(Dimension(force=-1, length=1), non_negative=True)]
RotationalCompliance = Annotated[Quantity, _Field(Dimension(force=-1, length=-1), non_negative=True)]

# along or about one axis of a joint: zero transmits nothing
AxisStiffness = Annotated[Quantity, _Field(Dimension(force=1, length=-1), non_negative=True, rigid=True)]
AxisRotationalStiffness = Annotated[Quantity, _Field(Dimension(force=1, length=1), non_negative=True, rigid=True)]

# entries of 6x6 matrices, by blocks: translation-translation, translation-rotation, rotation-rotation
StiffnessTT = Annotated[Quantity, _Field(Dimension(force=1, length=-1))]
StiffnessTR = Annotated[Quantity, _Field(Dimension(force=1))]
StiffnessRR = Annotated[Quantity, _Field(Dimension(force=1, length=1))]
ComplianceTT = Annotated[Quantity, _Field(Dimension(force=-1, length=1))]
ComplianceTR = Annotated[Quantity, _Field(Dimension(force=-1))]
ComplianceRR = Annotated[Quantity, _Field(Dimension(force=-1, length=-1))]
