"""How a machine answers forces: frequency responses, compliance, complex modes, state space, time response.

Everything here is reached through methods of `System` and `Modes`.
"""

from .complex_modes import ComplexModes
from .damping import DampingLike
from .flexibility import WeakMode
from .frequency_response import FrequencyResponse
from .quantity import Response
from .state_space import StateSpace

__all__ = ["ComplexModes", "DampingLike", "FrequencyResponse", "Response", "StateSpace", "WeakMode"]
