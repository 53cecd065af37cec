"""How one body is reduced, once the machine's defaults and those of the method are filled in."""

from __future__ import annotations

from dataclasses import dataclass

from .interface import Coupling, Interface, Method, Tie
from .schema import Body, ReductionDefaults

_COUPLING: dict[Method, Coupling] = {"joint-loaded": "averaged", "craig-bampton": "rigid"}
_TIE: dict[Method, Tie] = {"joint-loaded": "interface", "craig-bampton": "joint"}


@dataclass(frozen=True)
class Settings:
    """What holds for one body; coupling and tie are those of the method where they are None."""

    coupling: Coupling | None
    tie: Tie | None
    modes: int
    method: Method = "craig-bampton"

    @classmethod
    def of(cls, body: Body, defaults: ReductionDefaults) -> Settings:
        return cls(
            body.coupling or defaults.coupling,
            body.tie or defaults.tie,
            defaults.modes if body.modes is None else body.modes,
            body.method or defaults.method,
        )

    def coupling_of(self, interface: Interface) -> Coupling:
        return interface.coupling or self.coupling or _COUPLING[self.method]

    def tie_of(self, interface: Interface) -> Tie:
        return interface.tie or self.tie or _TIE[self.method]
