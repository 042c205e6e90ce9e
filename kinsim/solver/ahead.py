"""The time loop, compiled by another process while this one compiles the parts of a step; both keep code on disk."""

from __future__ import annotations

import math
import os
import subprocess
import sys

import numpy as np
from numba.core import config

from ..compiled.cache import PACKAGE, cache_folder
from ..schemes.tile import OPEN, SIZE, End
from .march import SEEN, Asked, march
from .sweep import KEPT, Shape
from .watch import NOBODY

_others: list[subprocess.Popen[bytes]] = []


def begin() -> None:
    """Let another process compile the time loop, if it is nowhere yet."""
    folder = cache_folder()
    if _others or folder is None or config.DISABLE_JIT or march.signatures:  # type: ignore[attr-defined]
        return
    if not sys.executable or (os.cpu_count() or 1) < 2 or any(folder.glob("march-*")):
        return
    path = os.pathsep.join([str(PACKAGE.parent), os.environ.get("PYTHONPATH", "")])
    command = [sys.executable, "-c", "from kinsim.solver.ahead import compile_loop; compile_loop()"]
    quiet = {"stdin": subprocess.DEVNULL, "stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    try:
        _others.append(subprocess.Popen(command, env={**os.environ, "PYTHONPATH": path}, **quiet))  # type: ignore[call-overload]
    except OSError:  # then this process does it all
        return


def wait() -> None:
    """Until that process is done; what it could not do is done here."""
    while _others:
        _others.pop().wait()


def compile_loop() -> None:
    """A march of no steps."""
    end, state = End(OPEN, 0.0, 0.0), tuple((np.zeros(5), np.zeros(5)) for _ in range(3))
    shape = Shape(1.0, end, end, *(0.0,) * (len(Shape._fields) - 3))
    asked = Asked(*(math.inf,) * len(Asked._fields))
    march(
        shape, np.zeros((8, 3), dtype=np.int64), np.zeros((2, 1)), asked, np.empty(0), 0, state, np.zeros((1, SIZE)),
        NOBODY, np.zeros((1, KEPT)), np.empty(1), np.zeros(SEEN), False, False,
    )  # fmt: skip
