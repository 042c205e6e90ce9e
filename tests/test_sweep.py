"""Scheme 1 in few sweeps against the rooms: the same bits in every array of the step."""

from __future__ import annotations

import numpy as np
import pytest

from kinsim import Blocks, Cells, ConstantSlope, Coulomb, Fitted, Kinetic, Macroscopic, Scene, Uniform, Window
from kinsim.balance.slide import TILE
from kinsim.model.boundary import Boundary
from kinsim.stepper import Sliding, Stepper, make_stepper

STAGES = ("h", "u", "q", "F1", "F2", "h1", "qhat", "J", "q1")


METHODS = {
    "closed": Macroscopic(1),
    "fitted": Kinetic(1, Fitted(3)),
    "nodes": Kinetic(1, Uniform(16, 4.0)),
    "window": Kinetic(1, Window(0.3), "sampled"),
}


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("nx", [2, 50, TILE, TILE + 1, 2 * TILE + 7])
@pytest.mark.parametrize("boundary", ["open", "wall", "periodic", ("open", "wall")])
def test_sweeps_are_the_step_of_the_rooms(name: str, boundary: Boundary, nx: int) -> None:
    """Dry cells, cells at rest and fast ones, on both sides of every edge of a tile."""
    dice = np.random.default_rng(nx)
    heap, friction = Blocks((0.5,), (1, 0.5)), Coulomb(0.2)
    scene = Scene(Cells(0, 1, nx), heap, ConstantSlope(0.1), friction, boundary=boundary, epsilon=0.4)
    h = dice.random(nx) * (dice.random(nx) > 0.2)
    q = h * dice.normal(size=nx) * (dice.random(nx) > 0.2)
    rooms, sweeps = Stepper(scene, METHODS[name]), make_stepper(scene, METHODS[name])
    assert isinstance(sweeps, Sliding)
    assert sweeps.begin(h, q) == rooms.begin(h, q)
    dt = 0.5 * scene.cells.dx / max(rooms.reach(), 1e-9)
    assert sweeps.advance(dt) == rooms.advance(dt)
    assert sweeps.reach() == rooms.reach()
    for stage in STAGES:
        np.testing.assert_array_equal(getattr(sweeps.now, stage), getattr(rooms.now, stage), stage)
    if rooms.density and sweeps.density:
        np.testing.assert_array_equal(sweeps.density.f, rooms.density.f)
