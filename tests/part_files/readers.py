"""Readers that do what a damaged file makes of a bad one."""

import ctypes
import time
from pathlib import Path
from typing import Any

import numpy as np


def sound(path: Path, factor: float) -> dict[str, Any]:
    return {"bytes": np.array(path.stat().st_size * factor)}


def crashing(path: Path) -> dict[str, Any]:
    ctypes.string_at(0)
    return {}


def hanging(path: Path) -> dict[str, Any]:
    time.sleep(60.0)
    return {}


def greedy(path: Path) -> dict[str, Any]:
    return {"much": np.ones(1 << 33)}


def talkative(path: Path) -> dict[str, Any]:
    for _ in range(1000):
        print("x" * 100_000)
    return {"said": np.array(1)}


def refusing(path: Path) -> dict[str, Any]:
    raise ValueError("line 3: found 'x', expected a number")


def failing(path: Path) -> dict[str, Any]:
    return {"key": {}["absent"]}


def leaving(path: Path) -> dict[str, Any]:
    raise SystemExit(0)
