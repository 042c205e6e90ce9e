"""Parts of a step that are compiled apart, and called by address."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.core import cgutils, config, errors, types
from numba.extending import intrinsic, overload

from ..errors import InputError
from .cache import CodeCache
from .kernel import INSIDE, classes_of, shortened


class Apart:
    """A function of values and of a place in a work array, compiled for the classes of the values, called by address.

    A kernel that calls such parts is compiled once for all classes, and the parts of many variants add up instead of
    multiplying. Numbers and arrays of the values stand in tables, so that all parts have the same signature:
    (numbers, arrays, dt, begin, n, first, last, room) -> number, the first two and the last being addresses.

    Attributes:
        address: Where it is; without compiling, a number by which `perform` finds it.
        row: The address, and those of its tables.
    """

    def __init__(self, function: Callable[..., Any], values: tuple[Any, ...], place: type) -> None:
        self._numbers: list[float] = []
        self._arrays: list[np.ndarray] = []
        names: dict[str, Any] = {"stage": function, "Place": place, "carray": numba.carray, "pointer": pointer}
        given = "".join(f"{self._written(value, names)}, " for value in values)
        self._table = np.array(self._numbers or [0.0])
        self._places = np.array(self._addresses() or [0], dtype=np.int64)
        self._function, self._place = function, place
        if config.DISABLE_JIT:
            self.address = len(_interpreted)
            _interpreted.append(lambda *given: 0.0)
            self._interpret(values)
        else:
            self.address = self._compiled(function, given, names, tuple(classes_of(values)))
        self.row = (self.address, self._table.ctypes.data, self._places.ctypes.data)

    def point_at(self, values: tuple[Any, ...]) -> None:
        """Take other values of the same classes."""
        self._numbers, self._arrays = [], []
        for value in values:
            self._written(value, {})
        self._table[: len(self._numbers)] = self._numbers
        self._places[: 3 * len(self._arrays)] = self._addresses()
        if config.DISABLE_JIT:
            self._interpret(values)

    def _addresses(self) -> list[int]:
        """Where the arrays stand, and their shapes."""
        return [int(x) for array in self._arrays for x in (array.ctypes.data, array.shape[0], array.shape[-1])]

    def _interpret(self, values: tuple[Any, ...]) -> None:
        function, place = self._function, self._place
        _interpreted[self.address] = lambda dt, begin, n, first, last, room: function(
            *values, dt, place(begin, n, bool(first), bool(last)), room
        )

    def _written(self, value: Any, names: dict[str, Any]) -> str:
        """The expression that makes a value of the tables."""
        if isinstance(value, tuple):
            inner = "".join(f"{self._written(part, names)}, " for part in value)
            name = type(value).__name__ if hasattr(value, "_fields") else ""
            if name:
                name = f"made_{len(names)}"
                names[name] = type(value)
            return f"{name}({inner})" if name else f"({inner})"
        if isinstance(value, np.ndarray):
            self._arrays.append(value)
            at = 3 * (len(self._arrays) - 1)
            shape = ", ".join(f"places[{at + 1 + axis}]" for axis in range(value.ndim))
            return f"carray(pointer(places[{at}]), ({shape},))"
        self._numbers.append(float(value))
        return f"numbers[{len(self._numbers) - 1}]"

    def _compiled(
        self, function: Callable[..., Any], given: str, names: dict[str, Any], classes: tuple[type, ...]
    ) -> int:  # fmt: skip
        key = (function.__name__, given, classes)
        if key not in _apart:
            size = f"{len(self._table)}"
            text = (
                f"def {function.__name__}(numbers_at, places_at, dt, begin, n, first, last, room_at, size):\n"
                f"    numbers = carray(pointer(numbers_at), {size})\n"
                f"    places = carray(whole_pointer(places_at), {len(self._places)})\n"
                "    room = carray(pointer(room_at), size)\n"
                f"    return float(stage({given}dt, Place(begin, n, first != 0, last != 0), room))\n"
            )
            names_out: dict[str, Any] = {}
            exec(text, names | {"whole_pointer": whole_pointer, "__name__": __name__}, names_out)
            part = numba.njit(error_model="numpy", nogil=True, no_cpython_wrapper=True)(names_out[function.__name__])
            kept = tuple(cls for cls in classes if cls is not tuple)
            part._cache = CodeCache(function.__name__, (function.__module__, function.__qualname__, text), kept)
            try:
                part.compile(PART.args)
            except errors.NumbaError as error:
                raise InputError(shortened(error)) from None
            made = part.overloads[PART.args]
            _apart[key] = made.library.get_pointer_to_function(made.fndesc.llvm_cfunc_wrapper_name), part
        return int(_apart[key][0])


PART = types.float64(*[types.int64] * 2, types.float64, *[types.int64] * 6)
"""Signature of all parts."""

_apart: dict[Any, tuple[int, Any]] = {}

_interpreted: list[Callable[..., float]] = [lambda *given: 0.0]


@intrinsic
def pointer(typing: Any, address: Any) -> Any:
    """The address of floats."""

    def build(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return builder.inttoptr(given[0], context.get_value_type(types.CPointer(types.float64)))

    return types.CPointer(types.float64)(types.int64), build


@intrinsic
def whole_pointer(typing: Any, address: Any) -> Any:
    """The address of whole numbers."""

    def build(context: Any, builder: Any, signature: Any, given: Any) -> Any:
        return builder.inttoptr(given[0], context.get_value_type(types.CPointer(types.int64)))

    return types.CPointer(types.int64)(types.int64), build


@intrinsic
def _call(typing: Any, address: Any, given: Any) -> Any:
    def build(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        arguments = cgutils.unpack_tuple(builder, values[1])
        kinds = [context.get_value_type(kind) for kind in PART.args]
        kind = ir.FunctionType(ir.DoubleType(), kinds)
        return builder.call(builder.inttoptr(values[0], kind.as_pointer()), arguments)

    return types.float64(types.int64, types.Tuple(PART.args)), build


def perform(
    rows: np.ndarray, which: int, dt: float, begin: int, n: int, first: bool, last: bool, room: np.ndarray
) -> float:
    """Call the part in row `which` of a table of `Apart.row`."""
    return _interpreted[int(rows[which, 0])](dt, begin, n, first, last, room)


@overload(perform, jit_options=INSIDE, strict=False)
def _perform(rows: Any, which: Any, dt: Any, begin: Any, n: Any, first: Any, last: Any, room: Any) -> Any:
    def in_kernels(rows, which, dt, begin, n, first, last, room):  # type: ignore[no-untyped-def]
        given = (
            rows[which, 1], rows[which, 2], dt, np.int64(begin), np.int64(n), np.int64(first), np.int64(last),
            np.int64(room.ctypes.data), np.int64(room.size),
        )  # fmt: skip
        return _call(rows[which, 0], given)

    return in_kernels
