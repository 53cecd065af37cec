"""The compiled kernels where numba is installed and has a place for what it compiles, else those in plain NumPy."""

from __future__ import annotations

import logging
from functools import cache
from importlib import import_module
from typing import Any

_log = logging.getLogger("prs_model")


@cache
def best(name: str) -> Any:
    """The kernels of a name, a module of this package: ``name_jit``, or else ``name``."""
    try:
        return import_module(f".{name}_jit", __package__)
    except (ImportError, RuntimeError) as error:
        _log.info("sweep: %s in NumPy (%s)", name, error)
        return import_module(f".{name}", __package__)
