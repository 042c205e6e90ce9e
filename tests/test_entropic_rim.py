"""`Entropic` where a node is about to enter the support, and fall-backs at faces."""

from __future__ import annotations

import numpy as np
import pytest

from kinsim import Cells, Fixed, Kinetic, Profile, Scene, Uniform, simulate
from kinsim.kinetic.equilibrium import Status
from kinsim.kinetic.equilibrium import fill as fill_rows
from kinsim.kinetic.velocity import Grid

BETA = 0.4


def fill(h: np.ndarray, u: np.ndarray, grid: Grid) -> tuple[np.ndarray, Status]:
    status = Status.empty(h.size)
    return fill_rows("entropic", h, u, h, u, BETA, grid, status), status


@pytest.mark.parametrize("n", [16, 64, 256])
def test_no_fall_back_where_a_node_enters_the_support(n: int, rng: np.random.Generator) -> None:
    """Heights within 1e-12 to 1e-3 of one at which the outermost pair of nodes enters, u as small."""
    grid = Grid(n, 5.0 / n)
    low = rng.uniform(0.1, 2.0, 12)
    high, still = low * (1.0 + 6.0 / n), np.zeros(12)
    before = (fill(low, still, grid)[0] > 0).sum(axis=1)
    for _ in range(50):
        middle = 0.5 * (low + high)
        entered = (fill(middle, still, grid)[0] > 0).sum(axis=1) > before
        low, high = np.where(entered, low, middle), np.where(entered, middle, high)
    near = np.repeat(low, 500)
    sizes = 10.0 ** rng.uniform(-12, -3, (2, near.size))
    h, u = near * (1.0 + rng.normal(size=near.size) * sizes[0]), rng.normal(size=near.size) * sizes[1]
    rows, status = fill(h, u, grid)
    assert status.converged.all()
    np.testing.assert_allclose(grid.dxi * rows.sum(axis=1), h, rtol=4e-15)
    np.testing.assert_allclose(grid.dxi * (rows @ grid.xi), h * u, atol=4e-15 * h.max())


def test_fall_backs_at_faces_are_counted() -> None:
    """Cells that can be matched, faces that cannot: the mean height of a face is a state of its own."""
    h = np.tile([0.0, 1e-7], 14)
    scene = Scene(Cells(0, 1.4, 28), Profile(h, np.where(h > 0, 0.33, 0.0)), epsilon=BETA)
    run = simulate(scene, Kinetic(2, Uniform(16, 3.0), "matched"), Fixed(1e-3, 1), 1)
    assert run.entries["fallbacks"][-1] > np.count_nonzero(h)
