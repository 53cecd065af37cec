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
        self._since = monotonic()
        self._rebuilt: Future[Parts] | None = None
        self._builder = ThreadPoolExecutor(max_workers=1)

    def suit(self, factors: Factors) -> bool:
        """Whether the parts are those that the machine would load with these factors."""
        return not self.follow_joints or factors == self._shaped_for

    def ask(self, factors: Factors) -> None:
        """Have the parts rebuilt once no other factors have been asked for a moment."""
        if factors != self._asked:
            self._asked, self._since = dict(factors), monotonic()

    def arrived(self) -> bool:
        """Start what is due; whether rebuilt parts have come. Raises PrsError when they cannot be built."""
        if self._rebuilt is None:
            if not self.suit(self._asked) and monotonic() - self._since > _QUIET:
                self._building, self._rebuilt = (
                    self._asked,
                    self._builder.submit(parts_under, self.machine, self._asked),
                )
            return False
        if not self._rebuilt.done():
            return False
        rebuilt, self._rebuilt, self._shaped_for = self._rebuilt, None, self._building
        self.parts = rebuilt.result()
        return True

    def close(self) -> None:
        """End the background work."""
        self._builder.shutdown(wait=True, cancel_futures=True)
