"""What exact solutions share: their numbers, the questions that they refuse, and the answers that they cannot give."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable
from functools import wraps
from numbers import Real
from typing import Annotated, Any, Concatenate, ParamSpec, TypeVar

import numpy as np
from numpy.typing import ArrayLike
from pydantic import Field

from ..arrays import Array
from ..errors import InputError
from ..value import Number

NonNegative = Annotated[Number, Field(ge=0)]
Positive = Annotated[Number, Field(gt=0)]

P = ParamSpec("P")
S = TypeVar("S")
T = TypeVar("T", bound=tuple[Any, ...])


def numbers(place: str, given: ArrayLike) -> Array:
    """`given` as an array of finite numbers; `place` names it.

    Raises:
        InputError: Something in it is none.
    """
    try:
        array = np.asarray(given)
        if array.dtype.kind not in "biufO":
            raise TypeError(array.dtype)
        array = array.astype(float)
    except (TypeError, ValueError, OverflowError):
        raise InputError(f"{place} is not a number, nor an array of them; give finite real ones") from None
    bad = array[~np.isfinite(array)]
    if bad.size:
        raise InputError(f"{place} holds {bad[0]}, not a number to go by; give finite ones")
    return array


def places(name: str, x: ArrayLike) -> Array:
    """`x` as an array of finite numbers.

    Raises:
        InputError: One is not a number.
    """
    return numbers(f"{name}: x", x)


def moment(name: str, t: float, until: float = math.inf) -> float:
    """`t`, a time from the start to `until`, where the solution ends.

    Raises:
        InputError: It is none.
    """
    given: Any = t
    now = given.item() if getattr(given, "shape", None) == () else given
    if not issubclass(type(now), Real):
        raise InputError(f"{name}: t is of type {type(t).__name__}, not one time; take a number, 0 <= t < infinity")
    if not 0.0 <= now <= sys.float_info.max:
        raise InputError(f"{name}: t = {now} is not a time at or after the start; take 0 <= t < infinity")
    if now > until:
        raise InputError(
            f"{name}: at t = {now:.6g} part of the mass has come to rest or turned; take 0 <= t <= {until!r}"
        )
    return float(now)


def held(*found: Any) -> bool:
    """Whether floating point holds them: all are finite."""
    return all(np.isfinite(part).all() for part in found)


def finite(answer: Callable[Concatenate[S, P], T]) -> Callable[Concatenate[S, P], T]:
    """Let a method of a solution give finite answers only; others, and overflows on the way, raise an `InputError`."""

    @wraps(answer)
    def asked(self: S, /, *args: P.args, **given: P.kwargs) -> T:
        try:
            with np.errstate(all="ignore"):
                found = answer(self, *args, **given)
        except ArithmeticError:
            found = None
        if found is None or not held(*found):
            raise InputError(f"{type(self).__name__}: {TOO_FAR}")
        return found

    return asked


TOO_FAR = "floating point cannot hold the solution; take heights, velocities, places and times nearer to 1"
