"""Where the time goes that the targets ask about: the profile beside the table."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from pathlib import Path

from cases import Case, Step, bare, stored
from fluxes import loop
from native import Native, library
from shell import SCENE, seconds
from timing import interleave

from kinsim import Fitted, Kinetic, Macroscopic

COMPILED = """
import sys, time
from numba.core import event
class Clock(event.Listener):
    depth = count = 0
    spent = 0.0
    def on_start(self, event):
        self.depth += 1
        self.count += 1
        self.began = time.process_time() if self.depth == 1 else self.began
    def on_end(self, event):
        self.depth -= 1
        self.spent += time.process_time() - self.began if self.depth == 0 else 0.0
clock = Clock()
event.register("numba:compile", clock)
"""

READ = """
import sys, time
from numba.core.caching import Cache
class Clock:
    count, spent, load = 0, 0.0, Cache.load_overload
clock = Clock()
def timed(*given):
    began = time.process_time()
    found = Clock.load(*given)
    clock.count, clock.spent = clock.count + 1, clock.spent + time.process_time() - began
    return found
Cache.load_overload = timed
"""

RUN = """
sys.argv = ["kinsim", "run", sys.argv[1], "--quiet"]
from kinsim.__main__ import main
try:
    main()
finally:
    print(clock.count, clock.spent)
"""

REGISTRIES = """
import kinsim.compiled
from numba.core.registry import cpu_target
cpu_target.typing_context.refresh()
cpu_target.target_context.refresh()
"""

STARTS = {
    "Python alone": "pass",
    "numpy": "import numpy",
    "numba": "import numba",
    "numba, and what it loads before the first kernel": REGISTRIES,
    "kinsim and its commands, no kernel yet": "import kinsim.cli, kinsim.simulate, kinsim.overview, kinsim.progress",
}


def parts(quick: bool) -> Iterator[tuple[str, str]]:
    """What, and how long it takes."""
    yield from starts(2 if quick else 7)
    yield from steps(quick)
    yield from least(quick)


def starts(rounds: int) -> Iterator[tuple[str, str]]:
    """What a start from the shell is made of, the least of some rounds."""
    with tempfile.TemporaryDirectory() as folder:
        env = {**os.environ, "KINSIM_CACHE_DIR": folder}
        env.pop("PYTHONDONTWRITEBYTECODE", None)
        for what, code in STARTS.items():
            yield f"start: {what}", f"{min(seconds(['-c', code], env) for _ in range(rounds)):.2f} s"
        for method in ("macroscopic", "kinetic"):
            scene = Path(folder) / f"{method}.toml"
            scene.write_text(SCENE.format(method=method), encoding="utf-8")
            env["KINSIM_CACHE_DIR"] = str(Path(folder) / method)
            count, spent = counted(COMPILED, scene, env)
            yield f"cold start, {method}: {count} functions compiled", f"{spent:.2f} s"
            count, spent = min((counted(READ, scene, env) for _ in range(rounds)), key=lambda found: found[1])
            yield f"warm start, {method}: {count} kernels read from the disk", f"{spent:.2f} s"


def counted(code: str, scene: Path, env: dict[str, str]) -> tuple[int, float]:
    """How many functions the run of a scene compiles or reads, and how long that takes."""
    said = subprocess.run(
        [sys.executable, "-c", code + RUN, str(scene)], env=env, capture_output=True, text=True, check=True
    )
    count, spent = said.stdout.split()[-2:]
    return int(count), float(spent)


def least(quick: bool) -> Iterator[tuple[str, str]]:
    """Steps of hardly any cells or nodes: what does not grow with them, and bends the exponents."""
    few, cells = Case.dam(10), Case.dam(200)
    calls: dict[str, Callable[[], object]] = {
        "10 cells: a step in closed form": Step(few, Macroscopic(1)),
        "10 cells: a step of Fitted 6": Step(few, Kinetic(1, Fitted(6))),
        "200 cells, 16 nodes: a step, window only": bare(cells, 16),
        "200 cells, 16 nodes: a step, carried f": stored(cells, 16),
    }
    for what, times in interleave(calls, rounds=5 if quick else 15).items():
        yield what, f"{1e6 * times.median:.3g} us"


def steps(quick: bool) -> Iterator[tuple[str, str]]:
    """The parts of a step."""
    for nx, n in ((400, 64),) if quick else ((400, 64), (2000, 256)):
        case = Case.dam(nx)
        calls: dict[str, Callable[[], object]] = {"U^{n+1}": bare(case, n), "U^{n+1} and f": stored(case, n)}
        if library():
            calls["the whole step in C"] = Native(case, n)
        for what, times in interleave(calls, rounds=5 if quick else 15).items():
            yield f"carried f, {nx}x{n}: {what}", f"{1e9 * times.median / (nx * n):.3g} ns per cell and node"
    case = Case.dam(50)
    for scheme in (1, 4):
        method = Macroscopic(scheme)  # type: ignore[arg-type]
        alone = interleave({"": Step(case, method)}, rounds=9)[""].all[0]
        whole = loop(case, method, 500 if quick else 2000)[0]
        yield f"50 cells, scheme {scheme}: the step itself", f"{1e6 * alone:.3g} us"
        yield f"50 cells, scheme {scheme}: the time loop around it", f"{1e6 * (whole - alone):.3g} us"
