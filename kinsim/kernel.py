"""The one decorator for compiled functions.

numba keeps compiled code on disk and trusts it as long as the file of the function itself is unchanged; a helper
edited in another file would leave old numbers behind. Here the stamp covers every kernel source of the package, and
the code is kept in the user's cache folder, so that a package folder that cannot be written is no obstacle.
"""

from __future__ import annotations

import hashlib
import os
import tempfile
from collections.abc import Callable
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from typing import Any, Literal, TypeVar

import numba
import platformdirs
from numba import types
from numba.core.caching import CompileResultCacheImpl, FunctionCache, _CacheLocator
from numba.core.registry import CPUDispatcher
from numba.extending import overload
from numba.np import linalg

from .local import at, left, right, varies

F = TypeVar("F", bound=Callable[..., Any])

PACKAGE = Path(__file__).parent


def _load_without_blas() -> None:
    """Load numba's array functions now, and let them find no BLAS: it would be all of scipy.linalg.

    numba asks once, for the inner product within a few functions; `np.dot` in somebody's own kernel asks anew.
    """
    asked = linalg.ensure_blas
    linalg.ensure_blas = _no_blas
    try:
        import_module("numba.np.arraymath")
    finally:
        linalg.ensure_blas = asked


def _no_blas() -> None:
    raise ImportError


_load_without_blas()


@cache
def source_stamp() -> str:
    """A hash of every source file of the package that holds kernels or numbers that they freeze."""
    digest = hashlib.sha256(numba.__version__.encode())
    for path in stamped():
        digest.update(path.relative_to(PACKAGE).as_posix().encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()


def stamped() -> list[Path]:
    """The source files that hold kernels, and those beside them in a folder of the package."""
    files = sorted(PACKAGE.rglob("*.py"))
    holding = {path for path in files if b"@kernel" in path.read_bytes()}
    folders = {path.parent for path in holding} - {PACKAGE}
    return [path for path in files if path in holding or path.parent in folders]


@cache
def cache_folder() -> str:
    """Where compiled kernels are kept: KINSIM_CACHE_DIR, else the user's cache folder, else a temporary one."""
    chosen = Path(os.environ.get("KINSIM_CACHE_DIR") or platformdirs.user_cache_path("kinsim")) / "kernels"
    try:
        chosen.mkdir(parents=True, exist_ok=True)
        tempfile.TemporaryFile(dir=chosen).close()
    except OSError:
        chosen = Path(tempfile.mkdtemp(prefix="kinsim-kernels-"))
    return str(chosen)


class _Locator(_CacheLocator):
    """Tells numba where a kernel's code is kept and when it is out of date."""

    def __init__(self, file: str) -> None:
        self._file = file

    def get_cache_path(self) -> str:
        return cache_folder()

    def get_source_stamp(self) -> str:
        return source_stamp()

    def get_disambiguator(self) -> str:
        return hashlib.sha256(self._file.encode()).hexdigest()[:12]

    @classmethod
    def from_function(cls, py_func: Callable[..., Any], py_file: str) -> _Locator:
        return cls(py_file)


class _Keep(CompileResultCacheImpl):
    _locator_classes = [_Locator]  # type: ignore[list-item]  # noqa: RUF012


class _Cache(FunctionCache):
    _impl_class = _Keep


def kernel(function: F) -> F:
    """Compile `function` when it is first called, and keep the code on disk.

    Kernels take arrays and scalars and write into arrays they are given. Division by zero gives infinity, as in numpy.
    """
    return _kept(numba.njit(error_model="numpy"), function)


def kernel_inner(function: F) -> F:
    """A kernel that kernels call: it gets no door for Python, which takes half of the time to compile it."""
    return _inner(function)


def kernel_part(function: F) -> F:
    """Such a one that is laid into every kernel that calls it: for the insides of loops, where a call would cost."""
    return _inner(function, forceinline=True)


def kernel_relaxed(*flags: Literal["contract", "reassoc", "nsz"]) -> Callable[[F], F]:
    """Such a part whose rounding the compiler may change, so that it runs in vector registers; NaN and infinity stay.

    "reassoc" and "nsz" take sums over a loop in any order, "contract" rounds a product and a sum together.
    """
    return lambda function: _inner(function, forceinline=True, fastmath=set(flags))


class _Inner(CPUDispatcher):
    """A kernel that is compiled for kernels only; where Python calls it, it is the Python function it was."""

    def __call__(self, *given: Any) -> Any:
        return self.py_func(*given)


def _inner(function: F, **options: Any) -> F:
    doors: dict[str, Any] = {"no_cpython_wrapper": True, "no_cfunc_wrapper": True}
    dispatcher: Any = _kept(numba.njit(error_model="numpy", **doors, **options), function)
    dispatcher.__class__ = _Inner
    return dispatcher  # type: ignore[no-any-return]


def _kept(njit: Callable[[F], Any], function: F) -> F:
    dispatcher = njit(function)
    dispatcher._cache = _Cache(function)  # type: ignore[no-untyped-call]
    return dispatcher  # type: ignore[no-any-return]


def _in_kernels(question: Callable[..., Any], answer: Callable[..., Any]) -> None:
    overload(question, jit_options={"error_model": "numpy", "forceinline": True}, strict=False)(answer)


@partial(_in_kernels, at)
def _at(value: Any, i: Any) -> Any:
    return (lambda value, i: value[i]) if isinstance(value, types.Array) else (lambda value, i: value)


@partial(_in_kernels, left)
def _left(value: Any) -> Any:
    return (lambda value: value[0]) if isinstance(value, types.BaseTuple) else (lambda value: value)


@partial(_in_kernels, right)
def _right(value: Any) -> Any:
    return (lambda value: value[1]) if isinstance(value, types.BaseTuple) else (lambda value: value)


@partial(_in_kernels, varies)
def _varies(value: Any) -> Any:
    return (lambda value: True) if isinstance(value, types.Array) else (lambda value: False)
