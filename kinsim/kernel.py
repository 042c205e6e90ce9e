"""How formulas become machine code; the only place that knows numba.

A *formula* is a function of numbers, or of one row, that stays callable from Python. A *question* is a formula whose
answer is a method of the class of its first argument: a flux, a law of friction, a scheme. In Python the object is
asked, in compiled code its class is, when the code is made. A *kernel* is called from Python; one that is *generic*
takes tuples of such values, and is compiled once for each combination of their classes.

Compiled code is kept on disk under a hash of all sources that went into it, so that an edit of any of them, in the
package or in a file of the user's, makes it anew. What is damaged or cannot be written costs a compilation, no run.
"""

from __future__ import annotations

import hashlib
import importlib
import inspect
import os
import pickle
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from typing import Any, Literal, TypeVar

import numba
import numpy as np
import platformdirs
from llvmlite import ir
from numba.core import cgutils, config, errors, types
from numba.core.compiler import CompileResult
from numba.extending import intrinsic, overload, register_jitable
from numba.np import linalg

from .errors import InputError

F = TypeVar("F", bound=Callable[..., Any])

PACKAGE = Path(__file__).parent

FRESH = 30 * 86400.0
"""Seconds after which compiled code of other sources is removed."""


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
        classes = tuple(_classes_of(given))
        if classes not in made:
            made[classes] = _dispatcher(function)
        try:
            return made[classes](*given)
        except errors.NumbaError as error:
            raise InputError(shortened(error)) from None

    call.__doc__, call.__name__ = function.__doc__, function.__name__
    return call  # type: ignore[return-value]


def _classes_of(given: Any) -> Iterator[type]:
    for value in given:
        if isinstance(value, tuple):
            yield type(value)
            yield from _classes_of(value)


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


# ---- parts that are compiled apart ---------------------------------------------------------------------------------


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
            self.address = self._compiled(function, given, names, tuple(_classes_of(values)))
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
                "def part(numbers_at, places_at, dt, begin, n, first, last, room_at, size):\n"
                f"    numbers = carray(pointer(numbers_at), {size})\n"
                f"    places = carray(whole_pointer(places_at), {len(self._places)})\n"
                "    room = carray(pointer(room_at), size)\n"
                f"    return float(stage({given}dt, Place(begin, n, first != 0, last != 0), room))\n"
            )
            names_out: dict[str, Any] = {}
            exec(text, names | {"whole_pointer": whole_pointer, "__name__": __name__}, names_out)
            part = numba.njit(error_model="numpy", nogil=True, no_cpython_wrapper=True)(names_out["part"])
            kept = tuple(cls for cls in classes if cls is not tuple)
            part._cache = _Cache(function.__name__, (function.__module__, function.__qualname__, text), kept)
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


# ---- the cache ----------------------------------------------------------------------------------------------------


def _dispatcher(function: Callable[..., Any], **doors: bool) -> Any:
    dispatcher = numba.njit(error_model="numpy", nogil=True, **(doors or {"no_cfunc_wrapper": True}))(function)
    dispatcher._cache = _Cache(function.__name__, (function.__module__, function.__qualname__), ())
    return dispatcher


@cache
def source_stamp() -> str:
    """A hash of numba's version and of every source file of the package that holds formulas."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in stamped():
        digest.update(path.relative_to(PACKAGE).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def stamped() -> list[Path]:
    """The source files that hold compiled functions, and those beside them in a folder of the package."""
    files = sorted(PACKAGE.rglob("*.py"))
    marks = (b"@kernel", b"@formula", b"@routine", b"@generic", b"@question", b"@short_question")
    holding = {path for path in files if any(mark in path.read_bytes() for mark in marks)}
    folders = {path.parent for path in holding} - {PACKAGE}
    return [path for path in files if path in holding or path.parent in folders]


@cache
def cache_folder() -> Path | None:
    """Where compiled code of these sources is kept: below KINSIM_CACHE_DIR, else below the user's cache folder.

    None if neither can be written: then it is kept in memory.
    """
    try:
        above = Path(os.environ.get("KINSIM_CACHE_DIR") or platformdirs.user_cache_path("kinsim")) / "kernels"
        chosen = above / source_stamp()[:16]
        chosen.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=chosen).close()
        os.utime(chosen)
        for other in above.iterdir():
            if other.is_dir() and time.time() - other.stat().st_mtime > FRESH:
                shutil.rmtree(other, ignore_errors=True)
    except (OSError, RuntimeError, KeyError):  # without a home, platformdirs asks who the user is
        return None
    return chosen


@cache
def _source_of(module: str) -> str | None:
    """A hash of the file of a module; None if another process could not import it."""
    if module in ("__main__", "builtins") or module not in sys.modules:
        return None
    try:
        return hashlib.sha256(Path(str(sys.modules[module].__file__)).read_bytes()).hexdigest()
    except (OSError, AttributeError):
        return None


def _frozen_in(cls: type) -> str:
    """The global values that formulas of a class from outside read, which their code freezes."""
    if cls.__module__.startswith("kinsim."):
        return ""
    read: dict[str, str] = {}
    for formula in [cls, *vars(cls).values()]:
        if inspect.isfunction(formula):
            found = inspect.getclosurevars(formula)
            read |= {name: _told(value) for name, value in {**found.globals, **found.nonlocals}.items()}
    return repr(sorted(read.items()))


def _told(value: Any) -> str:
    """A value that a formula reads; a function or class by its source."""
    try:
        return inspect.getsource(getattr(value, "py_func", value))
    except (OSError, TypeError):
        return repr(value)


def _classes_in(kind: Any) -> Iterator[type]:
    """The classes of values in a numba type."""
    if isinstance(kind, types.BaseNamedTuple):
        yield kind.instance_class
    if isinstance(kind, types.BaseTuple):
        for inner in getattr(kind, "types", ()):
            yield from _classes_in(inner)


class _Cache:
    """Keeps the compiled versions of one function, each in a file that names all that went into it."""

    def __init__(self, name: str, told: tuple[Any, ...], classes: tuple[type, ...]) -> None:
        self._name, self._told, self._classes = name, told, classes
        self.cache_path = str(cache_folder() or "")

    def enable(self) -> None:
        """numba asks for it; it is on from the start."""

    def disable(self) -> None:
        """numba asks for it; it stays on."""

    def flush(self) -> None:
        """Nothing waits to be written."""

    def load_overload(self, signature: Any, target: Any) -> Any:
        """The code for a signature, or None."""
        path = self._path(signature, target)
        try:
            if path is None or not path.exists():
                return None
            content = path.read_bytes()
            if hashlib.sha256(content[32:]).digest() != content[:32]:
                return None
            target.refresh()
            return CompileResult._rebuild(target, *pickle.loads(content[32:]))
        except Exception:  # whatever is wrong with a file, the code is made anew
            return None

    def save_overload(self, signature: Any, data: Any) -> None:
        """Keep the code for a signature, if it can be kept."""
        path = self._path(signature, data.target_context)
        if path is None or data.library.has_dynamic_globals:
            return
        try:
            content = pickle.dumps(data._reduce(), protocol=-1)
            with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as file:
                file.write(hashlib.sha256(content).digest() + content)
            os.replace(file.name, path)
        except Exception:  # a full disk, or a value that cannot be pickled: it is compiled again next time
            return

    def _path(self, signature: Any, target: Any) -> Path | None:
        """The file; None if a class of the signature belongs to this process alone, or if nothing can be kept."""
        folder, told = cache_folder(), []
        for cls in sorted({c for kind in signature for c in _classes_in(kind)} | set(self._classes), key=repr):
            made_of = getattr(cls, "made_of", cls)
            source = _source_of(made_of.__module__)
            if source is None or "<" in made_of.__qualname__:
                return None
            told.append((made_of.__module__, made_of.__qualname__, source, _frozen_in(made_of)))
        if folder is None:
            return None
        key = repr((self._told, str(signature), told, target.codegen().magic_tuple(), sys.version_info[:2]))
        return folder / f"{self._name}-{hashlib.sha256(key.encode()).hexdigest()[:24]}.code"
