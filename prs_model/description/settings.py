"""How one body is reduced, once the machine's defaults and those of the method are filled in."""

from __future__ import annotations

from dataclasses import dataclass

from .interface import Coupling, Interface, Method, Tie
from .schema import Body, ReductionDefaults

_COUPLING: dict[Method, Coupling] = {"joint-loaded": "averaged", "craig-bampton": "rigid"}
_TIE: dict[Method, Tie] = {"joint-loaded": "interface", "craig-bampton": "joint"}


@dataclass(frozen=True)
class Settings:
    """What holds for one body. The interfaces may differ in coupling and tie."""

    coupling: Coupling
    tie: Tie
    modes: int
    method: Method = "craig-bampton"

    @classmethod
    def of(cls, body: Body, defaults: ReductionDefaults) -> Settings:
        method = body.method or defaults.method
        return cls(
            body.coupling or defaults.coupling or _COUPLING[method],
            body.tie or defaults.tie or _TIE[method],
            defaults.modes if body.modes is None else body.modes,
            method,
        )

    def coupling_of(self, interface: Interface) -> Coupling:
        return interface.coupling or self.coupling

    def tie_of(self, interface: Interface) -> Tie:
        return interface.tie or self.tie
