"""What every section of a description is: entries of known names and types, and no others."""

from pydantic import BaseModel, ConfigDict


class Section(BaseModel):
    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)
