"""Which cells are slow, derived anew: by quadrature instead of closed forms, and from what friction means."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from kinsim import Scene
from kinsim.measure.reference import by_quadrature

Array = NDArray[np.float64]


def slow_cells(scene: Scene, h: Array, q: Array, dt: float) -> NDArray[np.bool_]:
    """Inner cells that one step of gravity and friction, -dt g h^{n+1}, would carry through rest, shape (nx - 2,).

    h^{n+1} is what the balanced flux leaves: both sides of a face have the mean of the two heights. A cell at rest is
    slow if anything pulls at it or holds it.
    """
    mean, u = 0.5 * (h[1:] + h[:-1]), q / h
    inward = -np.diff(by_quadrature((mean, u[:-1], mean, u[1:]), scene.beta)[0])
    pull = dt * (h[1:-1] + dt / scene.cells.dx * inward)
    least, most = pull * (scene.chute.sin - scene.resistance), pull * (scene.chute.sin + scene.resistance)
    q = q[1:-1]
    size = np.where(q > 0.0, np.abs(least), np.where(q < 0.0, np.abs(most), np.maximum(np.abs(least), np.abs(most))))
    slow: NDArray[np.bool_] = np.abs(q) < size
    return slow
