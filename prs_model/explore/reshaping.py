"""Parts that follow their joints: rebuilt in the background while springs have changed already."""

from __future__ import annotations

from concurrent.futures import Future, ThreadPoolExecutor
from time import monotonic

from ..machine import Machine
from ..reduction.gate import JOINT_LOADED
from ..reduction.store import provenance
from .answer import Parts
from .stiffness import Factors, parts_under

_QUIET = 0.3  # s without another change before parts are rebuilt


class Reshaping:
    """A machine's parts, as they are shaped now."""

    def __init__(self, machine: Machine, factors: Factors):
        self.machine, self.parts = machine, machine.parts
        self.follow_joints = any(provenance(part).get("basis") == JOINT_LOADED for part in self.parts.values())
        self._shaped_for = self._asked = dict(factors)
        self._failed_for: Factors | None = None
        self._since = monotonic()
        self._building: tuple[Factors, Future[Parts]] | None = None
        self._builder = ThreadPoolExecutor(max_workers=1)

    def suit(self, factors: Factors) -> bool:
        """Whether the parts are those that the machine would load with these factors."""
        return not self.follow_joints or factors == self._shaped_for

    def failed(self, factors: Factors) -> bool:
        """Whether parts for these factors could not be built: they are not tried again until others are asked for."""
        return factors == self._failed_for

    def ask(self, factors: Factors) -> None:
        """Have the parts rebuilt once no other factors have been asked for a moment."""
        if factors != self._asked:
            self._asked, self._since, self._failed_for = dict(factors), monotonic(), None

    def arrived(self) -> bool:
        """Start what is due; whether rebuilt parts have come. Raises whatever keeps them from being built, once."""
        if self._building is None:
            if self._is_due():
                self._building = self._asked, self._builder.submit(parts_under, self.machine, self._asked)
            return False
        factors, rebuilt = self._building
        if not rebuilt.done():
            return False
        self._building = None
        try:
            self.parts = rebuilt.result()
        except Exception:
            self._failed_for = factors
            raise
        self._shaped_for = dict(factors)
        return True

    def close(self) -> None:
        """End the background work."""
        self._builder.shutdown(wait=True, cancel_futures=True)

    def _is_due(self) -> bool:
        if self.suit(self._asked) or self.failed(self._asked):
            return False
        return monotonic() - self._since > _QUIET
