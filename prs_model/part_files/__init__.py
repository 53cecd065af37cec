"""Tools for reducers: labelled matrices to SI models and elements, text files, readers in a child process."""

from .child_process import read_apart
from .labelled import MODE, LabelledMatrices, NodeTable, full_model, super_element
from .text import read_text

__all__ = ["MODE", "LabelledMatrices", "NodeTable", "full_model", "read_apart", "read_text", "super_element"]
