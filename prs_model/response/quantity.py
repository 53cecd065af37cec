"""What a frequency response relates: the quantity, the six directions at a node, their units."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..arrays import FloatArray
from ..errors import PrsError, UnknownNameError, short

Response = Literal["receptance", "mobility", "accelerance"]
ComplexArray = NDArray[np.complex128]

DIRECTIONS = ("u", "v", "w", "ru", "rv", "rw")
"""Along and about the axes of the output frame."""

_SLOWEST, _FASTEST = 1e-9, 1e9  # Hz

_PER_TIME: dict[Response, str] = {"receptance": "", "mobility": "/s", "accelerance": "/s^2"}


def check_quantity(quantity: Response) -> None:
    """Raises UnknownNameError for a quantity that is none of the three."""
    if quantity not in get_args(Response):
        raise UnknownNameError("quantity", str(quantity), get_args(Response))


def from_receptance(receptance: ComplexArray, frequencies: FloatArray, quantity: Response) -> ComplexArray:
    """(f, ..) displacement, velocity or acceleration per force: times 1, j omega or -omega^2."""
    order = get_args(Response).index(quantity)
    factors = (2j * np.pi * frequencies) ** order
    return np.asarray(receptance * factors.reshape(-1, *[1] * (receptance.ndim - 1)))


def unit(response: str, excitation: str, quantity: Response = "receptance") -> str:
    """Such as ``m/N`` of ("u", "v"), ``rad/(N m)`` of ("rw", "rw"), ``m/s^2/N`` of an accelerance."""
    load = load_unit(excitation)
    return f"{motion_unit(response, quantity)}/{f'({load})' if ' ' in load else load}"


def motion_unit(direction: str, quantity: Response = "receptance") -> str:
    """Such as ``m`` or ``rad/s^2``."""
    return f"{'rad' if is_rotation(direction) else 'm'}{_PER_TIME[quantity]}"


def load_unit(direction: str) -> str:
    """``N`` or ``N m``."""
    return "N m" if is_rotation(direction) else "N"


def is_rotation(direction: str) -> bool:
    """Whether a direction is one of ru, rv, rw."""
    return DIRECTIONS.index(direction) >= 3


def pair_of(text: str) -> tuple[str, str]:
    """Response and excitation directions of ``w/u``, or of ``u``, which stands for ``u/u``. Raises PrsError."""
    if not isinstance(text, str):
        raise PrsError(f"direction: found {short(repr(text))}, expected one such as 'u', or response/excitation: 'w/u'")
    response, _, excitation = text.partition("/")
    for direction in (response, excitation or response):
        if direction not in DIRECTIONS:
            raise UnknownNameError("direction", direction, DIRECTIONS, "A pair is written response/excitation: w/u")
    return response, excitation or response


def listed_pairs(pairs: str | Sequence[str] | None) -> list[tuple[str, str]]:
    """The directions of texts such as ``w/u``, or of one; all 36 for None. Raises PrsError for an empty list."""
    if pairs is None:
        return [(response, excitation) for response in DIRECTIONS for excitation in DIRECTIONS]
    found = [pair_of(text) for text in ([pairs] if isinstance(pairs, str) else pairs)]
    if not found:
        raise PrsError("pairs: found none, expected one at least, such as 'u', or response/excitation: 'w/u'")
    return found


def frequencies_from(values: ArrayLike) -> FloatArray:
    """(f,) [Hz]. Raises PrsError unless they are numbers above zero that can be squared."""
    expected = f"a list of numbers above zero, {_SLOWEST:g} to {_FASTEST:g} [Hz]"
    frequencies = np.atleast_1d(real_numbers("frequencies", values, expected))
    wrong = frequencies[(frequencies < _SLOWEST) | (frequencies > _FASTEST)]
    if frequencies.ndim != 1 or not frequencies.size or wrong.size:
        found = f"{wrong[0]:g} Hz" if wrong.size else f"an array of shape {frequencies.shape}"
        raise PrsError(f"frequencies: found {found}, expected {expected}")
    return frequencies


def real_numbers(what: str, given: object, expected: str) -> FloatArray:
    """The array, or the number, that is given. Raises PrsError for what is none, complex, ragged or not finite."""
    try:
        array = np.asarray(given)
    except ValueError:  # lists of unequal lengths
        array = np.array(None)
    if array.dtype.kind not in "fiu":
        raise PrsError(f"{what}: found {short(' '.join(repr(given).split()))}, expected {expected}")
    if not np.all(np.isfinite(array)):
        raise PrsError(f"{what}: found {array[~np.isfinite(array)].flat[0]}, expected {expected}")
    return array.astype(float)


def six_digits(value: float) -> float:
    """A number as universal files hold it."""
    return float(f"{value:.5e}")
