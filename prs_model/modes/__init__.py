"""Natural modes: the eigenproblem, energies, characters in words, pictures."""

from .character import Character, shares_by_group
from .eigen import lowest_modes
from .modes import Modes, modes_of

__all__ = ["Character", "Modes", "lowest_modes", "modes_of", "shares_by_group"]
