"""From the shell: how long the command takes to start, and how much memory a run needs."""

from __future__ import annotations

import os
import resource
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from statistics import median

from rows import Row, most

SCENE = """
epsilon = 0.4
[cells]
left = -1
right = 1
count = 50
[heap]
kind = "blocks"
edges = [0]
heights = [1, 0.5]
[friction]
kind = "coulomb"
delta = 0.2
[method]
kind = "{method}"
[clock]
dt = 0.001
steps = 10
"""

MEMORY = """
import tracemalloc
from cases import Case, stored
stored(Case.dam(50), 64)
case = Case.dam({nx})
tracemalloc.start()
stored(case, {n})()
print(tracemalloc.get_traced_memory()[1] / (8 * {nx} * {n}))
"""


def rows(quick: bool) -> Iterator[Row]:
    """All rows of this file."""
    with tempfile.TemporaryDirectory() as folder:
        env = {**os.environ, "KINSIM_CACHE_DIR": folder}
        env.pop("PYTHONDONTWRITEBYTECODE", None)  # a second start finds what every second start finds
        help_times = [seconds(["-m", "kinsim", "--help"], env) for _ in range(3 if quick else 7)]
        yield most("kinsim --help, seconds", median(help_times), 0.3, spread(help_times))
        for method in ("macroscopic", "kinetic"):
            scene = Path(folder) / f"{method}.toml"
            scene.write_text(SCENE.format(method=method), encoding="utf-8")
            command = ["-m", "kinsim", "run", str(scene), "--quiet"]
            own = {**env, "KINSIM_CACHE_DIR": str(Path(folder) / method)}  # many kernels serve both
            cold = seconds(command, own)
            warm = [seconds(command, own) for _ in range(3 if quick else 5)]
            yield most(f"a small {method} run from the shell, warm cache, seconds", median(warm), 1.2, spread(warm))
            yield most(f"a small {method} run from the shell, cold cache, seconds", cold, 6.0)
    nx, n = (4000, 256) if quick else (20000, 512)
    code = MEMORY.format(nx=nx, n=n)
    found = subprocess.run(
        [sys.executable, "-c", code], cwd=Path(__file__).parent, capture_output=True, text=True, check=True
    )
    yield most(f"memory peak less baseline / f alone, carried f, {nx}x{n}", float(found.stdout), 1.5)


def seconds(command: list[str], env: dict[str, str]) -> float:
    """How long a process works, user and system; what it waits for a core that others have is left out."""
    began = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([sys.executable, *command], env=env, capture_output=True, check=True)
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    return ended.ru_utime - began.ru_utime + ended.ru_stime - began.ru_stime


def spread(times: list[float]) -> str:
    """Least, median and greatest."""
    return f"{min(times):.3g} / {median(times):.3g} / {max(times):.3g} s"
