"""A machine as its designer wants to see it: one page, and beside it every figure, number and animation."""

from .run import write_report

__all__ = ["write_report"]
