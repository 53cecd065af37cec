"""Natural modes: the eigenproblem, energies, characters in words, pictures."""

from .character import Character
from .eigen import lowest_modes
from .modes import Modes, modes_of

__all__ = ["Character", "Modes", "lowest_modes", "modes_of"]
