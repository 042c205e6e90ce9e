"""The same steps in C, compiled on the spot."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np
from cases import Array, Case

FLAGS = ("-O3", "-march=native", "-ffast-math", "-shared", "-fPIC")


@cache
def library() -> ctypes.CDLL | None:
    """What the C compiler of this machine makes of `steps.c`, or None where there is none."""
    compiler = shutil.which(os.environ.get("CC", "cc"))
    if compiler is None:
        return None
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "steps.so"
        subprocess.run([compiler, *FLAGS, "-o", path, Path(__file__).with_name("steps.c"), "-lm"], check=True)
        return ctypes.CDLL(str(path))


class Native:
    """A step of scheme 1 in C: with f on `n` sampled nodes, or in closed form for n = 0."""

    def __init__(self, case: Case, n: int = 0) -> None:
        lib, nx = library(), case.h.size
        if lib is None:
            raise RuntimeError("no C compiler")
        self._function = lib.carried if n else lib.closed
        self._function.restype = ctypes.c_double
        self.h1, self.q1, self.f = np.zeros(nx), np.zeros(nx), np.zeros((nx if n else 0, n))
        room = np.zeros(6 * (nx + 2) + 6 * n + 2)
        if n:
            dxi = 2.0 * case.bound / n
            xi = (np.arange(n) - n // 2 + 0.5) * dxi
            given = [case.h, case.q, xi, dxi * xi, dxi * xi**2, *case.force, room, self.h1, self.q1, self.f]
        else:
            given = [case.h, case.q, *case.force, room, self.h1, self.q1]
        self._alive = given
        sizes = [ctypes.c_long(size) for size in ((nx, n) if n else (nx,))]
        self._arguments = sizes + [_argument(thing) for thing in given]
        self()

    def __call__(self) -> None:
        self._function(*self._arguments)

    def result(self) -> list[Array]:
        """h, q at level n + 1, and f where it is carried."""
        return [self.h1, self.q1] + ([self.f] if self.f.size else [])


def _argument(thing: object) -> object:
    return ctypes.c_void_p(thing.ctypes.data) if isinstance(thing, np.ndarray) else ctypes.c_double(float(thing))  # type: ignore[arg-type]
