"""Reduction of parts to super-elements: rigid or averaged interfaces, Craig-Bampton, the store, the physics gate."""

from .elements import Elements
from .exports import export
from .part import build_part, read_part, reduce
from .super_element import SuperElement
from .surface import Surface
from .travelling import TravellingElement

__all__ = ["Elements", "SuperElement", "Surface", "TravellingElement", "build_part", "export", "read_part", "reduce"]
