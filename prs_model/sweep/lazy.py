"""Results larger than memory: arrays that read their pieces when they are asked for, and not before."""

from __future__ import annotations

from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from ..errors import MissingExtraError
from .store import Store

if TYPE_CHECKING:
    from numpy.typing import NDArray

IN_MEMORY = 2**30  # bytes


def results(store: Store) -> dict[str, Any]:
    """The results of all pieces: in memory, or lazy where they are many and Dask is installed."""
    start, stop = store.chunks[0]
    size = sum(values.nbytes for values in store.read(0).values()) * store.size / (stop - start)
    small = size <= IN_MEMORY or find_spec("dask") is None
    return dict(store.gather()) if small else lazy(store)


def lazy(store: Store) -> dict[str, Any]:
    """The results of all pieces as arrays of Dask, one chunk each piece; those with one number per pose in memory.

    A dataset of them is written to NetCDF or Zarr chunk by chunk. Raises PrsError for a first piece that is missing or
    damaged; of others that is said when they are read.
    """
    try:
        import dask.array as da
        from dask.delayed import delayed
    except ImportError as error:
        raise MissingExtraError("dask", "cluster", "results larger than memory") from error

    def array(name: str, like: NDArray[Any]) -> da.Array:
        shapes = {index: (stop - start, *like.shape[1:]) for index, (start, stop) in store.chunks.items()}
        parts = [
            da.from_delayed(delayed(_read, pure=True)(store, index, name), shape, like.dtype)
            for index, shape in shapes.items()
        ]
        whole: da.Array = da.concatenate(parts)
        return whole

    first = store.read(0)
    single = [name for name, values in first.items() if values.ndim == 1]
    return {name: array(name, values) for name, values in first.items()} | store.gather(*single)


def _read(store: Store, index: int, name: str) -> NDArray[Any]:
    return store.read(index, name)[name]
