"""Natural modes: the eigenproblem, energies, characters in words, pictures."""

from ..linear_algebra import lowest_modes
from .character import Character, shares_by_group
from .modes import Modes, modes_of

__all__ = ["Character", "Modes", "lowest_modes", "modes_of", "shares_by_group"]
