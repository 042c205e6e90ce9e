"""Compiled code on disk, under a hash of all that went into it.

An edit of any source, in the package or in a file of the user's, makes the code anew. What is damaged or cannot be
written costs a compilation, no run.
"""

from __future__ import annotations

import hashlib
import os
import pickle
import shutil
import sys
import tempfile
import time
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import numba
import platformdirs
from numba.core import types
from numba.core.compiler import CompileResult

from ..source import is_built_in, told

PACKAGE = Path(__file__).parent.parent

FRESH = 30 * 86400.0
"""Seconds after which compiled code of other sources is removed."""


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


class CodeCache:
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
                try:
                    file.write(hashlib.sha256(content).digest() + content)
                    file.close()
                    os.replace(file.name, path)
                except OSError:  # a full disk: it is compiled again next time
                    os.unlink(file.name)
        except Exception:  # a value that cannot be pickled, a folder that is gone: likewise
            return

    def _path(self, signature: Any, target: Any) -> Path | None:
        """The file; None if a class of the signature belongs to this process alone, or if nothing can be kept."""
        folder, sources = cache_folder(), list[Any]()
        for cls in sorted({c for kind in signature for c in _classes_in(kind)} | set(self._classes), key=repr):
            made_of = getattr(cls, "made_of", cls)
            source = _source_of(made_of.__module__)
            if source is None or "<" in made_of.__qualname__:
                return None
            reads = "" if is_built_in(made_of) else told(made_of)
            sources.append((made_of.__module__, made_of.__qualname__, source, reads))
        if folder is None:
            return None
        key = repr((self._told, str(signature), sources, target.codegen().magic_tuple(), sys.version_info[:2]))
        return folder / f"{self._name}-{hashlib.sha256(key.encode()).hexdigest()[:24]}.code"
