"""How formulas become machine code; the only place that knows numba.

A *formula* is a function of numbers, or of one row, that stays callable from Python. A *question* is a formula whose
answer is a method of the class of its first argument: a flux, a law of friction, a scheme. In Python the object is
asked, in compiled code its class is, when the code is made. A *kernel* is called from Python; one that is *generic*
takes tuples of such values, and is compiled once for each combination of their classes.
"""

from __future__ import annotations

import importlib
from collections.abc import Callable, Iterator
from typing import Any, Literal, TypeVar

import numba
import numpy as np
from numba.core import config, errors, types
from numba.extending import intrinsic, overload, register_jitable
from numba.np import linalg

from ..errors import InputError
from .cache import CodeCache

F = TypeVar("F", bound=Callable[..., Any])


def _load_without_blas() -> None:
    """Load numba's array functions now, and let them find no BLAS: it would be all of scipy.linalg."""
    asked = linalg.ensure_blas
    linalg.ensure_blas = _no_blas
    try:
        importlib.import_module("numba.np.arraymath")
    finally:
        linalg.ensure_blas = asked


def _no_blas() -> None:
    raise ImportError


_load_without_blas()


# ---- formulas, routines and questions -----------------------------------------------------------------------------


INSIDE: dict[str, Any] = {"error_model": "numpy", "no_cpython_wrapper": True, "no_cfunc_wrapper": True}
"""Options of what only compiled code calls: a door for Python would take time to compile."""


def formula(*flags: Literal["contract", "reassoc", "nsz", "nnan", "arcp"]) -> Callable[[F], F]:
    """A function of numbers or of one row, laid into every kernel that calls it.

    The flags let the compiler round differently. "contract" (a product and a sum rounded together) is allowed only
    where all arguments are the same in a mirrored flow, that is for functions of h and |u|; "reassoc" and "nsz" take a
    sum over a row in any order.
    """
    return register_jitable(**INSIDE, forceinline=True, fastmath=set(flags))


def routine(*flags: Literal["contract", "reassoc", "nsz", "nnan", "arcp"]) -> Callable[[F], F]:
    """A longer such function, compiled by itself and called."""
    return register_jitable(**INSIDE, fastmath=set(flags))


def question(default: F) -> F:
    """Ask the class of the first argument for a method of this name; `default` is the answer of those without one."""
    return _question(default, {})


def short_question(default: F) -> F:
    """The same for formulas of a line or two, which are laid into the code that asks."""
    return _question(default, {"forceinline": True})


def _question(default: F, options: dict[str, Any]) -> F:
    name = default.__name__

    def ask(asked: Any, *rest: Any) -> Any:
        return getattr(type(asked), name, default)(asked, *rest)

    def choose(asked: Any, *rest: Any) -> Any:
        return getattr(getattr(asked, "instance_class", None), name, default)

    overload(ask, jit_options=INSIDE | options, strict=False)(choose)
    ask.__doc__, ask.__name__ = default.__doc__, name
    return ask  # type: ignore[return-value]


def answers(asked: Any, question: Callable[..., Any]) -> bool:
    """Whether the class of a value has an answer of its own to a question."""
    return hasattr(type(asked), question.__name__)


def at(value: Any, i: int) -> float:
    """The number of place i: of one number for all places, or of an array."""
    return value[i] if isinstance(value, np.ndarray) else value


@overload(at, jit_options=INSIDE | {"forceinline": True}, strict=False)
def _at(value: Any, i: Any) -> Any:
    return (lambda value, i: value[i]) if isinstance(value, types.Array) else (lambda value, i: value)


def greatest(a: float, b: float) -> float:
    """max(a, b) of two numbers that are not NaN: the extreme of a loop over it is found in vector registers."""
    return max(a, b)


@intrinsic
def _greatest(typing: Any, a: Any, b: Any) -> Any:
    def build(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        larger = builder.fcmp_ordered(">", *given, flags=("nnan", "nsz"))
        return builder.select(larger, *given, flags=("nnan", "nsz"))

    return types.float64(types.float64, types.float64), build


@overload(greatest, jit_options=INSIDE | {"forceinline": True}, strict=False)
def _in_kernels(a: Any, b: Any) -> Any:
    return lambda a, b: _greatest(a, b)


# ---- kernels ------------------------------------------------------------------------------------------------------


def kernel(function: F) -> F:
    """A function of arrays and numbers, compiled when it is first called. Division by zero gives infinity."""
    if config.DISABLE_JIT:
        return function
    return _dispatcher(function)


def generic(function: F) -> F:
    """A kernel that takes tuples of values, compiled for each combination of their classes.

    numba tells classes of tuples apart by their names alone; here each combination has a dispatcher of its own.

    Raises:
        InputError: A formula of a class from outside of the package cannot be compiled; one line says why.
    """
    if config.DISABLE_JIT:
        return function
    made: dict[tuple[type, ...], Any] = {}

    def call(*given: Any) -> Any:
        classes = tuple(classes_of(given))
        if classes not in made:
            made[classes] = _dispatcher(function)
        try:
            return made[classes](*given)
        except errors.NumbaError as error:
            raise InputError(shortened(error)) from None

    call.__doc__, call.__name__ = function.__doc__, function.__name__
    return call  # type: ignore[return-value]


def classes_of(given: Any) -> Iterator[type]:
    """The classes of the tuples in a tuple of values."""
    for value in given:
        if isinstance(value, tuple):
            yield type(value)
            yield from classes_of(value)


def _dispatcher(function: Callable[..., Any], **doors: bool) -> Any:
    dispatcher = numba.njit(error_model="numpy", nogil=True, **(doors or {"no_cfunc_wrapper": True}))(function)
    dispatcher._cache = CodeCache(function.__name__, (function.__module__, function.__qualname__), ())
    return dispatcher


def plain(value: Any) -> Any:
    """A tuple of values as kernels take it: numbers become floats, lists and arrays contiguous arrays of floats."""
    if isinstance(value, tuple):
        inner = map(plain, value)
        return type(value)(*inner) if hasattr(value, "_fields") else tuple(inner)
    if isinstance(value, (np.ndarray, list)):
        return np.ascontiguousarray(value, dtype=float)
    return value if isinstance(value, (bool, str)) or callable(value) else float(value)


def shortened(error: Exception) -> str:
    """The line of a numba error that says what is wrong, and the line of code it is in."""
    lines = [line.strip() for line in str(error).splitlines() if line.strip()]
    skipped = (
        "Failed in",
        "During:",
        "File",
        "<source",
        "- Resolution",
        "This error",
        "Overload",
        "There are",
        "Rejected",
    )
    said = [line for line in lines if not line.startswith(skipped)]
    place = next((line for line in reversed(lines) if line.startswith("File") and "line " in line), "")
    number = place.split("line ")[-1].rstrip("):")
    return (f"line {number}: " if number else "") + (said[0] if said else str(error).split("\n")[0])
