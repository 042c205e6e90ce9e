"""A numerical flux from outside of the package: flux(h_left, u_left, h_right, u_right, beta) -> (F1, F2).

What numba can compile for numbers is compiled into the march. What it cannot, such as array code with masks, is called
with the faces of a tile at a time.
"""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numba
import numpy as np
from numba import types
from numba.core import config

from ..compiled import question, short_question
from ..errors import InputError
from ..schemes.bed import face
from ..schemes.formulas import drained
from ..schemes.questions import rows
from ..schemes.tile import F1, F2, HL, HR, SHARE, WALL, H, U
from ..source import told

Flux = Callable[..., Any]

TAKES = "(h_left, u_left, h_right, u_right, beta)"

OF_ROWS = ctypes.CFUNCTYPE(None, *[ctypes.c_void_p] * 7, ctypes.c_long)


class Outside(NamedTuple):
    """A flux of two states; a class of its own for each function has it as `between`, or as `faces_between`."""

    def flux_of_cells(flux, bed, place, low, high, f1, f2, room):
        faces_between(flux, bed, place, low, high, H, U, H + 1, U, f1, f2, room)

    def flux_of_states(flux, scheme, order, bed, place, lam, low, high, hl, ul, hr, ur, f1, f2, room):
        faces_between(flux, bed, place, low, high, hl, ul, hr, ur, f1, f2, room)

    def held_flux(flux, scheme, order, ground, lam, place, room):
        n = place.n
        _, up, _, um = rows(order)
        faces_between(flux, ground.bed, place, -2, n + 1, HL, up, HR, um, F1, F2, room)
        for k in range(-1, n + 1):
            out = max(room[F1 + k], 0.0) + max(-room[F1 + k - 1], 0.0)
            room[SHARE + k] = drained(room[H + k], out, lam)
        if place.first and ground.left.kind == WALL:
            room[SHARE - 1] = room[SHARE]
        if place.last and ground.right.kind == WALL:
            room[SHARE + n] = room[SHARE + n - 1]
        for k in range(-1, n):
            share = room[SHARE + k] if room[F1 + k] > 0.0 else room[SHARE + k + 1]
            room[F1 + k] *= share
            if share < 1.0:  # what is not sent has no pressure beyond that of what is
                room[F2 + k] *= share


@short_question
def between(flux: Any, h_left: float, u_left: float, h_right: float, u_right: float, beta: float) -> Any:
    """F of the states left and right of a face."""
    return flux.between(h_left, u_left, h_right, u_right, beta)


@question
def faces_between(
    flux: Any, bed: Any, place: Any, low: int, high: int, hl: int, ul: int, hr: int, ur: int, f1: int, f2: int,
    room: Any,
) -> None:  # fmt: skip
    """F of the faces `low` to below `high`."""
    for k in range(low, high):
        beta = face(bed, place.begin + k)[2]
        F = between(flux, room[hl + k], room[ul + k], room[hr + k], room[ur + k + 1], beta)
        room[f1 + k], room[f2 + k] = F[0], F[1]


_made: dict[Any, Any] = {}


def outside(function: Flux) -> Outside:
    """The flux of a function, NumPy or numba, of numbers or of arrays.

    Raises:
        InputError: It takes or gives something else.
    """
    key = function, told(function)
    if key not in _made:
        plain = getattr(function, "py_func", function)
        like = plain if hasattr(plain, "__qualname__") else type(plain)
        name, of_arrays = like.__name__, False
        try:
            first, second = (float(part) for part in function(0.4, 0.1, 0.3, -0.2, 0.9))
        except Exception as error:
            try:
                first, second = (float(part[0]) for part in function(*np.full((5, 1), 0.4)))
                of_arrays = True
            except Exception:
                raise InputError(f"flux {name}: takes {TAKES} and gives (F1, F2), but: {error}") from None
        if not (math.isfinite(first) and math.isfinite(second)):
            raise InputError(f"flux {name}: gives F = ({first:g}, {second:g}) between two wet states; give numbers")
        answers = _compiled(plain) or _by_rows(function, name, of_arrays or _takes_arrays(function))
        made = type(name, (Outside,), answers | {"__module__": like.__module__, "__qualname__": like.__qualname__})
        _made[key] = made()
    return _made[key]  # type: ignore[no-any-return]


def _takes_arrays(function: Flux) -> bool:
    """Whether a function that takes numbers takes arrays, too, with the same result."""
    states = np.array([[0.4, 0.0, 0.3], [0.1, 0.0, -0.9], [0.3, 0.2, 0.0], [-0.2, 0.5, 0.0], [0.9, 0.9, 0.9]])
    try:
        together = np.array([np.broadcast_to(part, 3) for part in function(*states)])
        return np.array_equal(together, np.array([function(*map(float, state)) for state in states.T]).T)
    except Exception:
        return False


def _compiled(plain: Flux) -> dict[str, Any] | None:
    """The function as one of numbers, if numba can compile it."""
    if config.DISABLE_JIT:
        return {"between": lambda flux, *states: plain(*states)}
    try:
        alone = numba.njit(error_model="numpy")(plain)
        alone.compile((types.float64,) * 5)
        given = alone.overloads[alone.signatures[0]].signature.return_type
        if len(given) != 2 or not all(isinstance(part, types.Number) for part in given):
            return None
    except Exception:
        return None

    def between(flux, h_left, u_left, h_right, u_right, beta):  # type: ignore[no-untyped-def]
        return alone(h_left, u_left, h_right, u_right, beta)

    return {"between": between}


def _by_rows(function: Flux, name: str, of_arrays: bool) -> dict[str, Any]:
    """The function, called back from compiled code with the faces of a tile; `trouble` says what it raised."""
    trouble: list[str] = []

    def call(*given: Any) -> None:
        count = given[-1]
        arrays = [
            np.ctypeslib.as_array(ctypes.cast(at, ctypes.POINTER(ctypes.c_double)), (count,)) for at in given[:-1]
        ]
        states = [part.copy() for part in arrays[:5]]
        try:
            one_by_one = [] if of_arrays else [function(*face) for face in zip(*states, strict=True)]
            arrays[5][:], arrays[6][:] = function(*states) if of_arrays else np.array(one_by_one).T
        except Exception as error:  # it cannot pass through compiled code; not-a-number ends the run
            trouble.append(f"flux {name}: {type(error).__name__}: {error}")
            arrays[5][:] = arrays[6][:] = np.nan

    pointer = OF_ROWS(call)

    def faces_between(flux, bed, place, low, high, hl, ul, hr, ur, f1, f2, room):  # type: ignore[no-untyped-def]
        betas = np.empty(high - low)
        for k in range(low, high):
            betas[k - low] = face(bed, place.begin + k)[2]
        pointer(
            room[hl + low : hl + high].ctypes, room[ul + low : ul + high].ctypes, room[hr + low : hr + high].ctypes,
            room[ur + 1 + low : ur + 1 + high].ctypes, betas.ctypes, room[f1 + low : f1 + high].ctypes,
            room[f2 + low : f2 + high].ctypes, high - low,
        )  # fmt: skip

    return {"faces_between": faces_between, "trouble": trouble}
