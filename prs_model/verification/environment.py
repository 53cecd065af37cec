"""What the times of a verification depend on."""

from __future__ import annotations

import os
import platform
from importlib.metadata import version


def environment() -> str:
    """Cores, threads, direct solver and versions in a few words."""
    threads = os.environ.get("OMP_NUM_THREADS", "all")
    cores = f"{os.cpu_count()} cores (threads of a library: {threads})"
    system = f"{platform.system()} {platform.machine()}, Python {platform.python_version()}"
    return f"{cores}, {_direct_solver()}, NumPy {version('numpy')}, {system}"


def _direct_solver() -> str:
    try:
        import pypardiso  # noqa: F401
    except (ImportError, OSError):  # not installed, or without the MKL it needs
        return f"SuperLU of SciPy {version('scipy')}"
    return f"MKL PARDISO by pypardiso {version('pypardiso')}"
