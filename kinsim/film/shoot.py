"""A scene is run for a film: the density kept at every frame, and beside it the twin in closed form."""

from __future__ import annotations

import math

from ..clock import AnyClock, Courant
from ..diagnostics.dump import Dump
from ..interrupt import unless_interrupted
from ..kinetic.velocity import Uniform
from ..memory import require
from ..method import Kinetic
from ..overview import first_steps
from ..read import SceneFile
from ..run import Run
from ..simulate import simulate
from ..simulation import Progress
from .reel import carries


def shoot(file: SceneFile, frames: int, force: bool = False, progress: Progress | None = None) -> list[Run]:
    """The run, and after a kinetic one that of its twin at the same times; about `frames` states are kept.

    Raises:
        InputError: The first step would break the CFL bound, or memory cannot hold the densities.
        KeyboardInterrupt: It was interrupted.
    """
    every = max(1, math.ceil(min(first_steps(file) / (frames - 1), 1e9)))
    dumps = [Dump(every=every)] if carries(file.method) else []
    if dumps:
        require(16.0 * frames * file.cells.count * _nodes(file), f"the density in {frames} frames")
    runs: list[Run] = []
    for method in (file.method, *([file.method.twin] if isinstance(file.method, Kinetic) else [])):
        clock: AnyClock = runs[0].replay if runs and isinstance(file.clock, Courant) else file.clock
        run = simulate(file.scene, method, clock, every, force=force, dumps=dumps, progress=progress)
        runs.append(unless_interrupted(run))
        if not runs[-1].steps:
            break
        dumps = []
    return runs


def _nodes(file: SceneFile) -> int:
    velocity = file.method.velocity  # type: ignore[union-attr]
    if isinstance(velocity, Uniform):
        return velocity.count
    return int(velocity.grid(file.scene.fastest).count)  # type: ignore[union-attr]
