"""LAPACK's generalised symmetric eigensolver called without Python's interpreter lock, so that threads share the cores.

SciPy's own wrappers hold the lock. The routine is the one SciPy ships for Cython (`scipy.linalg.cython_lapack`).
"""

from __future__ import annotations

import ctypes
from functools import cache
from typing import Any

import numpy as np
from scipy.linalg import LinAlgError, cython_lapack

from ..arrays import FloatArray

_BLOCK = 40  # columns per block of LAPACK's reductions: work space of n (8 + block)


def largest_of_pencil(a: FloatArray, b: FloatArray, count: int) -> tuple[FloatArray, FloatArray]:
    """The `count` largest eigenvalues of a x = mu b x, descending, and vectors (n, count) with x^T b x = 1.

    a, b: (n, n) symmetric, b positive definite. Raises LinAlgError when it is not, or where LAPACK does not converge.
    """
    n = len(a)
    count = min(count, n)
    a, b = np.array(a, order="F"), np.array(b, order="F")
    values, vectors, work = np.empty(n), np.empty((n, count), order="F"), np.empty(n * (8 + _BLOCK))
    integers, failed = np.empty(5 * n, dtype=np.int32), np.empty(n, dtype=np.int32)
    found, info = ctypes.c_int(0), ctypes.c_int(0)
    size, itype, one_norm = ctypes.c_int(n), ctypes.c_int(1), ctypes.c_double(0.0)
    first, last, room = ctypes.c_int(n - count + 1), ctypes.c_int(n), ctypes.c_int(len(work))
    _dsygvx()(
        _at(itype), b"V", b"I", b"L", _at(size), a.ctypes, _at(size), b.ctypes, _at(size), _at(one_norm),
        _at(one_norm), _at(first), _at(last), _at(one_norm), _at(found), values.ctypes, vectors.ctypes, _at(size),
        work.ctypes, _at(room), integers.ctypes, failed.ctypes, _at(info),
    )  # fmt: skip
    if info.value or found.value != count:
        raise LinAlgError(f"dsygvx: info {info.value}, {found.value} of {count} eigenvalues found")
    return values[:count][::-1], vectors[:, ::-1]


def _at(value: Any) -> Any:
    return ctypes.byref(value)


@cache
def _dsygvx() -> Any:
    capsule = cython_lapack.__pyx_capi__["dsygvx"]
    name, pointer = ctypes.pythonapi.PyCapsule_GetName, ctypes.pythonapi.PyCapsule_GetPointer
    name.restype, name.argtypes = ctypes.c_char_p, [ctypes.py_object]
    pointer.restype, pointer.argtypes = ctypes.c_void_p, [ctypes.py_object, ctypes.c_char_p]
    return ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 23)(pointer(capsule, name(capsule)))
