"""Run a scene."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from .checkpoint import Checkpoint, Keeper
from .clock import AnyClock, Courant, Fixed, Replay
from .diagnostics.dump import Dump
from .diagnostics.endings import ENDED
from .diagnostics.history import Cadence
from .errors import InputError
from .method import Kinetic, Macroscopic
from .run import Run
from .scene import Scene
from .simulation import Progress, Simulation
from .solver.asked import strongest
from .solver.march import REACH


@np.errstate(all="ignore")  # a number that is none stops the run, with a verdict
def simulate(
    scene: Scene,
    method: Kinetic | Macroscopic,
    clock: AnyClock,
    save_every: int | None = None,
    *,
    save_at: Sequence[float] | None = None,
    rows: int | None = None,
    observers: Sequence[Any] = (),
    force: bool = False,
    dumps: Sequence[Dump] = (),
    causes: bool = False,
    checkpoint: Checkpoint | None = None,
    progress: Progress | None = None,
) -> Run:
    """Run a scene.

    Args:
        scene: What happens.
        method: How it is computed.
        clock: When.
        save_every: Every so many steps the state is kept. This or one of the next two; without any, about 100 states
            are kept. The first and the last state always are.
        save_at: Times at which the state is kept; a step ends on each exactly, for steps are shortened.
        rows: So many times, evenly spread, likewise.
        observers: Objects with a method `look`, or functions, that get each block of steps, or every n-th step if they
            have `every = n`; a text that they return ends the run. See `kinsim.diagnostics.observer.Observer`.
        force: Run although the CFL bound (28) is broken; the verdict says so.
        dumps: Densities to keep; of methods on a velocity grid only.
        causes: Keep the moment ledger, too: what each stage did to mass, momentum, energy and entropy; grid only.
        checkpoint: Where the run is put down now and then, and on Ctrl-C and SIGTERM; `resume` goes on with it.
        progress: Called now and then with the share that is done.

    Returns:
        The run; its verdict says whether it went to the end. A run that is stopped keeps its last good state.

    Raises:
        InputError: The first step would break the CFL bound, or the request makes no sense.
    """
    _check(scene, method, clock)
    cadence = Cadence(clock, save_every, save_at, rows)
    if isinstance(method, Kinetic) and method.unbounded:
        method = method.within(find_bound(scene, method, clock, force))
    simulation = Simulation(scene, method, clock, cadence, force, dumps, causes, observers)
    if checkpoint:
        simulation.keeper = Keeper(checkpoint, simulation.about())
    simulation.start()
    return simulation.run(progress)


def _check(scene: Scene, method: Kinetic | Macroscopic, clock: AnyClock) -> None:
    """The three that meet here are what they should be."""
    for name, given, kinds in (
        ("scene", scene, (Scene,)),
        ("method", method, (Kinetic, Macroscopic)),
        ("clock", clock, (Fixed, Courant, Replay)),
    ):
        if not isinstance(given, kinds):
            wanted = " or ".join(kind.__name__ for kind in kinds)
            raise InputError(f"simulate: {name} is of type {type(given).__name__}; give a {wanted}")


def find_bound(scene: Scene, method: Kinetic, clock: AnyClock, force: bool = False) -> float:
    """1.05 times the largest |u| + c + dt |g| of a run of the closed-form twin, face states included.

    Where the twin breaks the CFL bound it ends, unless forced: so does then the run itself, on its own grid.
    """
    twin = Simulation(scene, method.twin, clock, Cadence(clock, 2**62, None, None), force)
    first_reach = twin.solver.scene.fastest
    twin.history.start(twin.solver)
    while twin.verdict is None and (block := twin.block()):
        twin.longest = max(twin.longest, float(block.dts.max(initial=0.0)))
        twin.conclude(block)
    if twin.verdict and twin.verdict.kind == "non-finite":  # forced beyond (28): what blows up asks for any window
        return 10.0 * first_reach or 1.0
    last = twin.solver.fastest if twin.verdict and twin.verdict.kind in ENDED else 0.0
    largest = max(float(twin.solver.seen[REACH]), last) + twin.longest * strongest(scene)
    return 1.05 * largest if 0.0 < largest < math.inf else 1.0
