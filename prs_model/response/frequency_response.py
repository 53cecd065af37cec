"""A frequency response with its labels and units, and the ways to make and to keep one."""

from __future__ import annotations

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from numpy.typing import ArrayLike

from ..arrays import FloatArray
from .damping import DampingLike, damping_of
from .frf import direct_receptance, modal_receptance
from .points import Point, point
from .quantity import (
    DIRECTIONS,
    ComplexArray,
    Response,
    check_quantity,
    frequencies_from,
    from_receptance,
    pair_of,
    unit,
)
from .residual import is_truncated

_BEYOND = 1.3  # times the last frequency kept: up to there most of what is left out is known at rest
_log = logging.getLogger("prs_model")

if TYPE_CHECKING:
    import xarray

    from ..modes import Modes
    from ..synthesis import System


class Node(NamedTuple):
    """Its number, the same for one name at all poses, and position (3,) [m] from the world's origin, along u, v, w."""

    number: int
    position: FloatArray


@dataclass(frozen=True, eq=False, repr=False)
class FrequencyResponse:
    """values (f, 6, 6): motion of node `to` along and about u, v, w for a unit force or moment at node `at`.

    frequencies (f,) [Hz]; rows are responses, columns excitations, translations first; a node is ``body.node``, or
    ``output``, and `nodes` has its number and place. quantity: displacement (receptance), velocity (mobility) or
    acceleration (accelerance) per force.
    """

    frequencies: FloatArray
    values: ComplexArray
    quantity: Response
    to: str
    at: str
    nodes: Mapping[str, Node]

    def __repr__(self) -> str:
        band = f"{self.frequencies.min():g} .. {self.frequencies.max():g} Hz"
        return f"FrequencyResponse({self.quantity} at {self.to} by {self.at}, {len(self.frequencies)} x {band})"

    def curve(self, pair: str) -> ComplexArray:
        """(f,): one entry, such as ``u``, or ``w/u`` for the motion along w by a force along u. Raises PrsError."""
        response, excitation = pair_of(pair)
        return self.values[:, DIRECTIONS.index(response), DIRECTIONS.index(excitation)]

    def unit(self, pair: str) -> str:
        """Such as ``m/N``."""
        return unit(*pair_of(pair), self.quantity)

    def to_xarray(self) -> xarray.DataArray:
        """Dimensions frequency, response, excitation; the unit of each entry is a coordinate."""
        import xarray

        units = [[unit(response, excitation, self.quantity) for excitation in DIRECTIONS] for response in DIRECTIONS]
        array = xarray.DataArray(
            self.values,
            dims=("frequency", "response", "excitation"),
            coords={
                "frequency": self.frequencies,
                "response": list(DIRECTIONS),
                "excitation": list(DIRECTIONS),
                "unit": (("response", "excitation"), units),
            },
            name=self.quantity,
            attrs={"to": self.to, "at": self.at},
        )
        array.frequency.attrs["units"] = "Hz"
        return array

    def save(self, path: str | Path, pairs: str | Sequence[str] | None = None, title: str = "") -> None:
        """Write .csv, .uff (dataset 58, extra `uff`) or a picture .png, .svg, .pdf (extra `plot`), whole or not at all.

        pairs: which entries, such as ("u", "w/u"), or one; default: all, of a picture those on the diagonal.
        Raises PrsError or MissingExtraError.
        """
        from .files import save

        save(self, Path(path), pairs, title)


def of_modes(
    modes: Modes,
    frequencies_hz: ArrayLike,
    damping: DampingLike,
    to: str | None,
    at: str | None,
    quantity: Response,
    static_correction: bool,
) -> FrequencyResponse:
    """By superposition of modes; see Modes.frf."""
    check_quantity(quantity)
    frequencies = frequencies_from(frequencies_hz)
    model = damping_of(modes.system, damping)
    ends = point(modes.system, to), point(modes.system, at)
    _warn_beyond(modes, frequencies)
    receptance = modal_receptance(modes, frequencies, model, *ends, static_correction)
    values = from_receptance(receptance, frequencies, quantity)
    return _labelled(frequencies, values, quantity, *ends)


def of_system(
    system: System,
    frequencies_hz: ArrayLike,
    damping: DampingLike,
    to: str | None,
    at: str | None,
    quantity: Response,
) -> FrequencyResponse:
    """By a solve for each frequency; see System.frf."""
    check_quantity(quantity)
    frequencies = frequencies_from(frequencies_hz)
    model = damping_of(system, damping)
    ends = point(system, to), point(system, at)
    values = from_receptance(direct_receptance(system, frequencies, model, *ends), frequencies, quantity)
    return _labelled(frequencies, values, quantity, *ends)


def _labelled(
    frequencies: FloatArray, values: ComplexArray, quantity: Response, to: Point, at: Point
) -> FrequencyResponse:
    nodes = {end.name: Node(end.number, end.position) for end in (to, at)}
    return FrequencyResponse(frequencies, values, quantity, to.name, at.name, nodes)


def _warn_beyond(modes: Modes, frequencies: FloatArray) -> None:
    last, highest = float(modes.frequencies[-1]), float(frequencies.max())
    if is_truncated(modes) and highest > _BEYOND * last > 0.0:
        _log.warning(
            "the response is asked for up to %.4g Hz, and the last of %d modes is at %.4g Hz: beyond that it is a "
            "guess; take more modes, or System.frf",
            highest,
            len(modes.frequencies),
            last,
        )
