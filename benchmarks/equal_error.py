"""Time to equal error on a dam that breaks onto a wet bed: first order, second order, and PyClaw.

h = 1 | 0.5 at rest on [-1, 1], beta = 0.4, no friction, to t = 0.6. For each method cells are doubled until L1(h) to
the exact solution is below 3e-4; the time to exactly 3e-4 lies between the last two, on a straight line in logarithms.
Times are those of the time loop alone, the best of three, on one core; nothing is saved on the way.

PyClaw (classic, Roe's solver with entropy fix in Fortran, second order) is taken from this interpreter or from
another one that has it: ``python benchmarks/equal_error.py --clawpack /path/to/python``. Without either it is left out.
"""

from __future__ import annotations

import argparse
import json
import math
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np

GOAL, BETA, END = 3e-4, 0.4, 0.6
REPEATS = 3

Answer = tuple[float, float]
"""L1(h), seconds."""


@cache
def exact(count: int) -> np.ndarray:
    """Averages of the exact height at the end."""
    from kinsim import Cells
    from kinsim.exact import Riemann

    return Riemann(1, 0, 0.5, 0, BETA).averages(Cells(-1, 1, count), END)[0]


def error(h: np.ndarray) -> float:
    """L1(h)."""
    return float(np.abs(h - exact(h.size)).sum() * 2.0 / h.size)


def kinsim_run(number: float, order: int, limiter: str, wing: str, count: int) -> Answer:
    """Scheme 4 at a Courant number."""
    from kinsim import Blocks, Cells, Courant, Fitted, Frictionless, Kinetic, Macroscopic, Scene, simulate

    scene = Scene(Cells(-1, 1, count), Blocks((0,), (1, 0.5)), friction=Frictionless(), epsilon=BETA)
    keys = {"order": order, "limiter": limiter}
    method = Macroscopic(4, **keys) if wing == "closed" else Kinetic(4, Fitted(6), **keys)
    runs = [simulate(scene, method, Courant(number, END), 2**40) for _ in range(REPEATS)]
    return error(runs[0].h[-1]), min(run.wall_time for run in runs)


def pyclaw_here(count: int, limiter: str) -> tuple[list[float], float]:
    """Heights at the end and the best time, in an interpreter that has clawpack."""
    import logging

    from clawpack import pyclaw, riemann

    logging.disable(logging.CRITICAL)
    best = math.inf
    for _ in range(REPEATS):
        solver = pyclaw.ClawSolver1D(riemann.shallow_roe_with_efix_1D)
        solver.order, solver.cfl_desired, solver.cfl_max = 2, 0.9, 1.0
        solver.max_steps, solver.dt_initial = 10**7, 0.5 * 2.0 / count
        solver.limiters = getattr(pyclaw.limiters.tvd, limiter)
        solver.bc_lower[0] = solver.bc_upper[0] = pyclaw.BC.extrap
        domain = pyclaw.Domain(pyclaw.Dimension(-1.0, 1.0, count, name="x"))
        state = pyclaw.State(domain, 2)
        state.problem_data.update(grav=BETA, dry_tolerance=1e-12, sea_level=0.0)
        state.q[0] = np.where(domain.grid.x.centers < 0, 1.0, 0.5)
        state.q[1] = 0.0
        solution = pyclaw.Solution(state, domain)
        solver.setup(solution)
        began = time.perf_counter()
        solver.evolve_to_time(solution, END)
        best = min(best, time.perf_counter() - began)
    return solution.q[0].tolist(), best


def pyclaw_run(python: str, limiter: str, count: int) -> Answer:
    """The same through another interpreter."""
    command = [python, str(Path(__file__).resolve()), "--answer", str(count), limiter]
    with tempfile.TemporaryDirectory() as scratch:  # pyclaw leaves a log where it runs
        said = subprocess.run(command, check=True, capture_output=True, text=True, cwd=scratch).stdout
    h, seconds = json.loads(said.splitlines()[-1])
    return error(np.array(h)), seconds


def reach(run: Callable[[int], Answer], start: int, goal: float) -> tuple[float, float]:
    """Cells and seconds at which L1(h) is the goal."""
    count, before = start, run(start)
    if before[0] < goal:
        raise RuntimeError(f"{start} cells are too fine a start: L1(h) = {before[0]:.2g}")
    while True:
        after = run(2 * count)
        if after[0] < goal:
            share = math.log(before[0] / goal) / math.log(before[0] / after[0])
            return count * 2**share, before[1] * (after[1] / before[1]) ** share
        count, before = 2 * count, after


def main() -> None:
    """Print a table in Markdown, and write it where `.ci/tables.py` finds it for a page."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--clawpack", default=sys.executable if find_spec("clawpack") else "", metavar="PYTHON")
    parser.add_argument("--quick", action="store_true", help="ten times the error: whether it runs, no measurement")
    parser.add_argument("--out", type=Path, metavar="EQUAL_ERROR.JSON")
    parser.add_argument("--answer", nargs=2, metavar=("CELLS", "LIMITER"), help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.answer:
        print(json.dumps(pyclaw_here(int(asked.answer[0]), asked.answer[1])))
        return
    ways: dict[str, tuple[Callable[[int], Answer], int]] = {
        "scheme 4, first order, Courant 0.9": (partial(kinsim_run, 0.9, 1, "between", "closed"), 2000),
        "scheme 4, second order, between, Courant 0.9": (partial(kinsim_run, 0.9, 2, "between", "closed"), 250),
        "scheme 4, second order, mc, Courant 0.9": (partial(kinsim_run, 0.9, 2, "mc", "closed"), 250),
        "scheme 4, second order, mc, 6 fitted nodes": (partial(kinsim_run, 0.9, 2, "mc", "fitted"), 250),
    }
    if asked.clawpack:
        for limiter in ("MC", "minmod"):
            name = f"PyClaw, second order, {limiter}, Courant 0.9"
            ways[name] = (partial(pyclaw_run, asked.clawpack, limiter), 250)
    goal, coarser = (10 * GOAL, 10) if asked.quick else (GOAL, 1)
    found = {name: reach(run, start // coarser, goal) for name, (run, start) in ways.items()}
    best = min(seconds for name, (_, seconds) in found.items() if name.startswith("scheme 4, second"))
    heads = ["method", "cells", "time, ms", "over the fastest second order of scheme 4"]
    rows = [
        [name, f"{cells:.0f}", f"{1e3 * seconds:.3g}", f"{seconds / best:.2f}"]
        for name, (cells, seconds) in found.items()
    ]
    for row in (heads, ["---"] * len(heads), *rows):
        print(f"| {' | '.join(row)} |")
    if asked.out:
        caption = f"Time to L1(h) = {goal:g}, by `benchmarks/equal_error.py` on one core"
        record = {"tables": [{"caption": caption, "heads": heads, "rows": rows}]}
        asked.out.write_text(json.dumps(record, indent=1), encoding="utf-8")
    if not asked.clawpack:
        print("\nPyClaw was left out: no clawpack here; name an interpreter that has it with --clawpack.")


if __name__ == "__main__":
    main()
