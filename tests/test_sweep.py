"""Scheme 1 in closed form in two sweeps against the rooms: the same bits in every array of the step."""

from __future__ import annotations

import numpy as np
import pytest

from kinsim import Blocks, Cells, ConstantSlope, Coulomb, Macroscopic, Scene
from kinsim.macroscopic.sweep import TILE
from kinsim.model.boundary import Boundary
from kinsim.stepper import Stepper, Swept, make_stepper

STAGES = ("h", "u", "q", "F1", "F2", "h1", "qhat", "J", "q1")


@pytest.mark.parametrize("nx", [2, 3, 50, TILE - 1, TILE, TILE + 1, 2 * TILE + 7])
@pytest.mark.parametrize("boundary", ["open", "wall", "periodic", ("open", "wall")])
def test_two_sweeps_are_the_step_of_the_rooms(boundary: Boundary, nx: int) -> None:
    """Dry cells, cells at rest and fast ones, on both sides of every edge of a tile."""
    dice = np.random.default_rng(nx)
    heap, friction = Blocks((0.5,), (1, 0.5)), Coulomb(0.2)
    scene = Scene(Cells(0, 1, nx), heap, ConstantSlope(0.1), friction, boundary=boundary, epsilon=0.4)
    h = dice.random(nx) * (dice.random(nx) > 0.2)
    q = h * dice.normal(size=nx) * (dice.random(nx) > 0.2)
    rooms, sweeps = Stepper(scene, Macroscopic(1)), make_stepper(scene, Macroscopic(1))
    assert type(sweeps) is Swept
    assert sweeps.begin(h, q) == rooms.begin(h, q)
    dt = 0.5 * scene.cells.dx / max(rooms.reach(), 1e-9)
    assert sweeps.advance(dt) == rooms.advance(dt)
    assert sweeps.reach() == rooms.reach()
    for name in STAGES:
        np.testing.assert_array_equal(getattr(sweeps.now, name), getattr(rooms.now, name), name)
