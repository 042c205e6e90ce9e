"""Wall times of many methods on one scene, in runs that take turns."""

from __future__ import annotations

import time
from collections.abc import Sequence

import numpy as np

from kinsim import Fixed, Kinetic, Run, Scene, simulate


def in_turns(scene: Scene, methods: Sequence[Kinetic], clock: Fixed, seconds: float) -> tuple[list[Run], np.ndarray]:
    """A run of each method, and the least seconds that its time loop took in turns that go on for `seconds`.

    The machine has other work, and the least of several times has the least of it.
    """
    runs = [simulate(scene, method, clock, 2**62) for method in methods]
    least = np.array([run.wall_time for run in runs])
    begun = time.perf_counter()
    while time.perf_counter() - begun < seconds:
        least = np.minimum(least, [simulate(scene, method, clock, 2**62).wall_time for method in methods])
    return runs, least
