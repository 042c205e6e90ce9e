"""Where f may be negative, the march looks for its least entry in every step."""

from __future__ import annotations

import numpy as np

from ..kinetic.rows import CHUNK, Carrier, Watch, is_summed
from ..kinetic.velocity import Grid
from ..method import Kinetic, Macroscopic
from ..schemes.tile import Model

NOBODY = Watch(np.zeros((0, 3), dtype=np.int64), np.zeros(4), np.zeros((0, 1)))
"""Does not look."""


def watch_of(
    model: Model, method: Kinetic | Macroscopic, grid: Grid | None, force: bool
) -> tuple[Carrier | None, Watch]:  # fmt: skip
    """What finds the least entry of f where it may be negative, and the carrier whose tables that reads."""
    if grid is None or (method.keeps_positive and not force):
        return None, NOBODY
    if is_summed(model.projection):
        return None, NOBODY._replace(f=model.projection.f)
    carrier = Carrier(model, CHUNK, grid.side)
    return carrier, carrier.watch()
