"""Results larger than memory: arrays that read their pieces when they are asked for, and not before."""

from __future__ import annotations

from importlib.util import find_spec
from math import prod
from typing import TYPE_CHECKING, Any

import numpy as np

from ...errors import MissingExtraError
from .store import Layout, Store, blank

if TYPE_CHECKING:
    from numpy.typing import NDArray

IN_MEMORY = 2**30  # bytes


def results(store: Store) -> dict[str, Any]:
    """The results of all pieces: in memory, or lazy where they are many and Dask is installed."""
    each = sum(prod(shape) * np.dtype(dtype).itemsize for shape, dtype in store.layout().values())
    small = each * store.size <= IN_MEMORY or find_spec("dask") is None
    return dict(store.gather()) if small else lazy(store)


def lazy(store: Store) -> dict[str, Any]:
    """The results of all pieces as arrays of Dask, one chunk each piece; those with one number per pose in memory.

    A dataset of them is written to NetCDF or Zarr chunk by chunk. Raises PrsError for a piece that is missing or
    damaged; when a piece is damaged later, that is said when it is read.
    """
    try:
        import dask.array as da
        from dask.delayed import delayed
    except ImportError as error:
        raise MissingExtraError("dask", "cluster", "results larger than memory") from error

    def array(name: str, like: Layout) -> da.Array:
        parts = [
            da.from_delayed(delayed(_read, pure=True)(store, index, name, like), (stop - start, *like[0]), like[1])
            for index, (start, stop) in store.chunks.items()
        ]
        whole: da.Array = da.concatenate(parts)
        return whole

    layout = store.layout()
    single = [name for name, (shape, _) in layout.items() if not shape]
    return {name: array(name, like) for name, like in layout.items() if like[0]} | store.gather(*single)


def _read(store: Store, index: int, name: str, like: Layout) -> NDArray[Any]:
    found = store.read(index, name)
    start, stop = store.chunks[index]
    return found[name] if name in found else blank((stop - start, *like[0]), like[1])
