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
from numba.core import config, errors, types
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


def formula(*flags: Literal["contract", "reassoc", "nsz", "nnan", "arcp"]) -> Callable[[F], F]:
    """A function of numbers or of one row, laid into every kernel that calls it.

    The flags let the compiler round differently. "contract" (a product and a sum rounded together) is allowed only
    where all arguments are the same in a mirrored flow, that is for functions of h and |u|; "reassoc" and "nsz" take a
    sum over a row in any order.
    """
    return register_jitable(error_model="numpy", forceinline=True, fastmath=set(flags))  # type: ignore[no-any-return]


def routine(*flags: Literal["contract", "reassoc", "nsz", "nnan", "arcp"]) -> Callable[[F], F]:
    """A longer such function, compiled by itself and called."""
    return register_jitable(error_model="numpy", fastmath=set(flags))  # type: ignore[no-any-return]


def question(default: F) -> F:
    """Ask the class of the first argument for a method of this name; `default` is the answer of those without one."""
    name = default.__name__

    def ask(asked: Any, *rest: Any) -> Any:
        return getattr(type(asked), name, default)(asked, *rest)

    def choose(asked: Any, *rest: Any) -> Any:
        return getattr(getattr(asked, "instance_class", None), name, default)

    overload(ask, jit_options={"error_model": "numpy"}, strict=False)(choose)
    ask.__doc__, ask.__name__ = default.__doc__, name
    return ask  # type: ignore[return-value]


def short_question(default: F) -> F:
    """The same for formulas of a line or two, which are laid into the code that asks."""
    name = default.__name__

    def ask(asked: Any, *rest: Any) -> Any:
        return getattr(type(asked), name, default)(asked, *rest)

    def choose(asked: Any, *rest: Any) -> Any:
        return getattr(getattr(asked, "instance_class", None), name, default)

    overload(ask, jit_options={"error_model": "numpy", "forceinline": True}, strict=False)(choose)
    ask.__doc__, ask.__name__ = default.__doc__, name
    return ask  # type: ignore[return-value]


def at(value: Any, i: int) -> float:
    """The number of place i: of one number for all places, or of an array."""
    return value[i] if isinstance(value, np.ndarray) else value  # type: ignore[no-any-return]


@overload(at, jit_options={"forceinline": True}, strict=False)
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


@overload(greatest, jit_options={"forceinline": True}, strict=False)
def _in_kernels(a: Any, b: Any) -> Any:
    return lambda a, b: _greatest(a, b)


# ---- kernels ------------------------------------------------------------------------------------------------------


def kernel(function: F) -> F:
    """A function of arrays and numbers, compiled when it is first called. Division by zero gives infinity."""
    if config.DISABLE_JIT:
        return function
    return _dispatcher(function)  # type: ignore[no-any-return]


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
    skipped = ("Failed in", "During:", "File", "<source", "- Resolution", "This error", "Overload", "There are", "Rejected")
    said = [line for line in lines if not line.startswith(skipped)]
    place = next((line for line in reversed(lines) if line.startswith("File") and "line " in line), "")
    number = place.split("line ")[-1].rstrip("):")
    return (f"line {number}: " if number else "") + (said[0] if said else str(error).split("\n")[0])


# ---- the cache ----------------------------------------------------------------------------------------------------


def _dispatcher(function: Callable[..., Any]) -> Any:
    dispatcher = numba.njit(error_model="numpy", nogil=True)(function)
    dispatcher._cache = _Cache(function)
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


def _classes_in(kind: Any) -> Iterator[type]:
    """The classes of values in a numba type."""
    if isinstance(kind, types.BaseNamedTuple):
        yield kind.instance_class
    if isinstance(kind, types.BaseTuple):
        for inner in getattr(kind, "types", ()):
            yield from _classes_in(inner)


class _Cache:
    """Keeps the compiled versions of one function, each in a file that names all that went into it."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._name = f"{function.__module__}.{function.__qualname__}"
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
        if path is None or any(lib.has_dynamic_globals for lib in (data.library,) if hasattr(lib, "has_dynamic_globals")):
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
        for cls in sorted({c for kind in signature for c in _classes_in(kind)}, key=repr):
            made_of = getattr(cls, "made_of", cls)
            source = _source_of(made_of.__module__)
            if source is None or "<locals>" in made_of.__qualname__:
                return None
            told.append((made_of.__module__, made_of.__qualname__, source))
        if folder is None:
            return None
        key = repr((self._name, str(signature), told, target.codegen().magic_tuple(), sys.version_info[:2]))
        return folder / f"{self._name.rsplit('.', 1)[-1]}-{hashlib.sha256(key.encode()).hexdigest()[:24]}.code"
