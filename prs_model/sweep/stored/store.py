"""A sweep kept in a folder, piece by piece: what is finished stays finished, whatever ends the process.

```
run.json           what is computed (its identity), how many poses, how many in each piece
plan.npz           the plan, made once: whoever goes on evaluates the same one
piece-000123.npz   the results of the poses 123 n .. 124 n - 1
lock               who is at work
```

Every file is written under another name and renamed, so it is there whole or not at all; its checksums are tested when
it is read. Nothing in it is pickled.
"""

from __future__ import annotations

import json
import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from io import BytesIO
from math import prod
from pathlib import Path
from typing import Any
from zipfile import ZipFile

import numpy as np
from numpy.typing import NDArray

from ...errors import PrsError, short
from ...modes.figure_file import told
from ...reduction.recipe import differences, fingerprint
from ...reduction.storage import whole
from .lock import LOCK, locked

FORMAT = "prs-model sweep"
RUN = "run.json"
VERSION = 1
MOST = 4096  # poses in a piece
PIECES = 64  # a small sweep has about as many, so that several processes share the work

_REMEDY = "run the sweep again with this folder, and it is computed anew"

Block = dict[str, NDArray[Any]]
"""Results of consecutive poses by name; the first axis counts the poses."""

Layout = tuple[tuple[int, ...], str]
"""Of an array, without its first axis: shape and type."""

logger = logging.getLogger("prs_model")


@dataclass(frozen=True)
class Store:
    """A folder that holds the run of one identity. size: of the sweep; length: poses in a piece, fewer in the last."""

    folder: Path
    run: str
    size: int
    length: int

    @property
    def chunks(self) -> dict[int, tuple[int, int]]:
        """Number of each piece, and the poses start .. stop - 1 in it."""
        return {index: self._span(index) for index in range(-(-self.size // self.length))}

    def plan(self, make: Callable[[], Block]) -> Block:
        """The arrays of the plan that was kept; made and kept where there is none. Raises PrsError."""
        path = self.folder / "plan.npz"
        try:
            return self._read(path, ())
        except FileNotFoundError:
            logger.info("%s: no plan yet", self.folder)
        except PrsError as error:
            logger.warning("%s, made anew", error)
        plan = make()
        self._write(path, plan, ())
        return plan

    def finished(self) -> set[int]:
        """The pieces that are there and sound. A damaged one is told of in the log, and is to be computed again."""
        return {index for index in self.chunks if self._is_sound(index)}

    def unfinished(self) -> dict[int, tuple[int, int]]:
        """Those of the chunks that are still to be computed."""
        finished = self.finished()
        return {index: span for index, span in self.chunks.items() if index not in finished}

    def write(self, index: int, block: Mapping[str, NDArray[Any]]) -> None:
        """Keep the results of a piece, over what may be there. Raises PrsError, and then nothing has changed."""
        start, stop = self._span(index)
        wrong = {name: values.shape for name, values in block.items() if values.shape[:1] != (stop - start,)}
        if wrong:
            raise PrsError(f"piece {index}: found arrays of shapes {wrong}, expected {stop - start} poses")
        self._write(self._path(index), block, self._span(index))

    def read(self, index: int, *names: str) -> Block:
        """The results of a piece, or those of some names. Raises PrsError for one that is missing or damaged."""
        with self._piece(index) as (file, arrays):
            return {name: _array(file, name) for name in arrays if name in names or not names}

    def gather(self, *names: str) -> Block:
        """All results in memory, or those of some names. Raises PrsError for a piece that is missing or damaged."""
        block = {
            name: blank((self.size, *shape), dtype)
            for name, (shape, dtype) in self.layout().items()
            if name in names or not names
        }
        for index, (start, stop) in self.chunks.items():
            for name, values in self.read(index, *names).items():
                block[name][start:stop] = values
        return block

    def layout(self) -> dict[str, Layout]:
        """What is known of each pose, from all pieces. Raises PrsError as `gather`."""
        found: dict[str, Layout] = {}
        for index in self.chunks:
            with self._piece(index) as (_, arrays):
                found = arrays | found
            if wrong := [name for name, own in arrays.items() if found[name] != own]:
                raise PrsError(f"{self._path(index)}: '{wrong[0]}' differs from other pieces; delete {self.folder}")
        return found

    def _is_sound(self, index: int) -> bool:
        try:
            self._read(self._path(index), self._span(index))
        except FileNotFoundError:
            return False
        except PrsError as error:
            logger.warning("%s, computed again", error)
            return False
        return True

    def _path(self, index: int) -> Path:
        return self.folder / f"piece-{index:06d}.npz"

    def _span(self, index: int) -> tuple[int, int]:
        return index * self.length, min((index + 1) * self.length, self.size)

    def _write(self, path: Path, arrays: Mapping[str, NDArray[Any]], span: tuple[int, ...]) -> None:
        layout = {name: (array.shape[1:], array.dtype.str) for name, array in arrays.items()}
        header = {"run": fingerprint(self.run), "poses": span, "arrays": layout}
        contents = {"header": np.array(json.dumps(header)), **arrays}
        with told(path), whole(path) as file, ZipFile(file, "w") as archive:
            for name, array in contents.items():
                with archive.open(f"{name}.npy", "w", force_zip64=True) as member:
                    np.lib.format.write_array(member, array, allow_pickle=False)

    def _read(self, path: Path, span: tuple[int, ...]) -> Block:
        """Raises FileNotFoundError, or PrsError for what is damaged."""
        with self._archive(path, span) as (file, arrays):
            return {name: _array(file, name) for name in arrays}

    @contextmanager
    def _piece(self, index: int) -> Iterator[tuple[ZipFile, dict[str, Layout]]]:
        """A piece to read from, and its arrays. Raises PrsError for one that is missing or damaged."""
        path = self._path(index)
        try:
            with self._archive(path, self._span(index)) as piece:
                yield piece
        except FileNotFoundError as error:
            raise PrsError(f"{path}: there is no such piece; {_REMEDY}") from error
        except PrsError as error:
            raise PrsError(f"{error}; {_REMEDY}") from error

    @contextmanager
    def _archive(self, path: Path, span: tuple[int, ...]) -> Iterator[tuple[ZipFile, dict[str, Layout]]]:
        try:
            with ZipFile(path) as file:
                header = json.loads(str(_array(file, "header")))
                if (header["run"], header["poses"]) != (fingerprint(self.run), list(span)):
                    raise ValueError("it is of another sweep or of other poses")
                yield file, {name: (tuple(shape), dtype) for name, (shape, dtype) in header["arrays"].items()}
        except (FileNotFoundError, MemoryError):
            raise
        except Exception as error:  # whatever zip, numpy or json make of damaged bytes
            raise PrsError(f"{path}: damaged ({short(error) or type(error).__name__})") from error


def _array(file: ZipFile, name: str) -> NDArray[Any]:
    """An array whose checksum was tested."""
    array: NDArray[Any] = np.lib.format.read_array(BytesIO(file.read(f"{name}.npy")), allow_pickle=False)
    return array


def blank(shape: tuple[int, ...], dtype: str) -> NDArray[Any]:
    """What stands where a piece has nothing, none of its poses being reachable: NaN, or zero where there is none."""
    return np.full(shape, np.nan if np.dtype(dtype).kind == "f" else 0, dtype)


@contextmanager
def opened(folder: str | Path, run: str, shape: tuple[int, ...]) -> Iterator[Store]:
    """The folder of a run, made where there is none, and held as long as it is open: one process at a time.

    run: the identity of the sweep, canonical JSON; shape: of its poses.
    Raises PrsError for a folder of another run, one with other files in it, one in use, one that cannot be written, or
    one without a name.
    """
    if not isinstance(folder, str | Path) or not str(folder).strip():
        raise PrsError(f"store: found '{folder}', expected the name of a folder")
    folder = Path(folder)
    with ExitStack() as held:
        with told(folder):
            folder.mkdir(parents=True, exist_ok=True)
            _check_own(folder)
            held.enter_context(locked(folder))
            store = _begun(folder, run, shape)
        yield store


def piece_length(shape: tuple[int, ...]) -> int:
    """Poses in a piece: whole rows of a grid where they are short enough."""
    size, row = prod(shape), next((length for length in reversed(shape) if length > 1), 1)
    length = max(1, min(MOST, size // PIECES))
    return length // row * row or length


def _check_own(folder: Path) -> None:
    strangers = [path.name for path in folder.iterdir() if path.name != LOCK and not path.name.startswith(f".{RUN}.")]
    if strangers and RUN not in strangers:
        found = f"found a folder with other files in it ('{short(min(strangers))}')"
        raise PrsError(f"{short(folder)}: {found}, expected a new one, or one with a sweep")


def _begun(folder: Path, run: str, shape: tuple[int, ...]) -> Store:
    """What the folder has of the run, rid of what a killed process left half-written; else its beginning."""
    for half_written in (*folder.glob(".*.npz.*"), *folder.glob(f".{RUN}.*")):
        half_written.unlink()
    path = folder / RUN
    if path.exists():
        return _continued(path, run, shape)
    length = piece_length(shape)
    content = {"format": FORMAT, "version": VERSION, "poses_per_piece": length, "run": json.loads(run)}
    with whole(path) as file:
        file.write(json.dumps(content, indent=1).encode())
    return Store(folder, run, prod(shape), length)


def _continued(path: Path, run: str, shape: tuple[int, ...]) -> Store:
    remedy = "name another folder, or delete this one"
    try:
        content = json.loads(path.read_bytes())
        stored = json.dumps(content["run"], sort_keys=True, separators=(",", ":"))
        length = int(content["poses_per_piece"])
        if (content["format"], content["version"]) != (FORMAT, VERSION) or length < 1:
            raise ValueError(f"found version {content['version']}, expected {VERSION}")
        differ = [] if stored == run else differences(run, stored)
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise PrsError(f"{path}: is not of a sweep that can be continued ({short(error)}); {remedy}") from error
    if stored != run:
        raise PrsError(f"{short(path.parent)}: holds another sweep ({_first(differ)}); {remedy}")
    logger.info("%s: continued", path.parent)
    return Store(path.parent, run, prod(shape), length)


def _first(differences: list[str]) -> str:
    """The first differences in words, those that say more than a checksum before others."""
    told = [short(each) for each in sorted(differences, key=lambda each: "sha256" in each)]
    return "; ".join(told[:3]) + (f"; and {len(told) - 3} more" if len(told) > 3 else "")
