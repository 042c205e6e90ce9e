"""Schemes 1 and 4 in few sweeps against the rooms: the same bits in every array of the step."""

from __future__ import annotations

import numpy as np
import pytest

from kinsim import Blocks, Cells, ConstantSlope, Coulomb, Fitted, Kinetic, Macroscopic, Scene, Uniform, Window
from kinsim.balance.slide import TILE
from kinsim.model.boundary import Boundary
from kinsim.stepper import Settling, Sliding, Stepper, make_stepper

STAGES = ("h", "u", "q", "F1", "F2", "h1", "qhat", "J", "q1")


METHODS = {
    "closed": Macroscopic(1),
    "fitted": Kinetic(1, Fitted(3)),
    "nodes": Kinetic(1, Uniform(16, 4.0)),
    "window": Kinetic(1, Window(0.3), "sampled"),
}


def same_step(sweeps: Stepper, rooms: Stepper, h: np.ndarray, q: np.ndarray, stages: tuple[str, ...]) -> None:
    """One step of each from (h, q): every stage, what is returned, to the bit."""
    assert sweeps.begin(h, q) == rooms.begin(h, q)
    dt = 0.5 * rooms.scene.cells.dx / max(rooms.reach(), 1e-9)
    assert sweeps.advance(dt) == rooms.advance(dt)
    assert sweeps.reach() == rooms.reach()
    for stage in stages:
        np.testing.assert_array_equal(getattr(sweeps.now, stage), getattr(rooms.now, stage), stage)


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
    same_step(sweeps, rooms, h, q, STAGES)
    if rooms.density and sweeps.density:
        np.testing.assert_array_equal(sweeps.density.f, rooms.density.f)


HELD = (*STAGES, "e", "theta", "still", "held", "low", "high")
HOLDING = {"closed": Macroscopic(4), "fitted": Kinetic(4, Fitted(3))}


@pytest.mark.parametrize("name", HOLDING)
@pytest.mark.parametrize("nx", [2, 3, 50, 601])
@pytest.mark.parametrize("zeta", [-0.4, 0.0, 0.1, 0.5])
@pytest.mark.parametrize("boundary", ["open", "wall", "periodic", ("open", "wall")])
def test_settling_is_the_step_of_the_rooms(name: str, boundary: Boundary, zeta: float, nx: int) -> None:
    """Dry, hardly wet, resting, creeping and fast cells, and a pile at its steepest; zeta below and above delta."""
    dice = np.random.default_rng(nx)
    heap, friction = Blocks((0.5,), (1, 0.5)), Coulomb(0.2)
    scene = Scene(Cells(0, 1, nx), heap, ConstantSlope(zeta), friction, boundary=boundary, epsilon=0.4)
    rooms, sweeps = Stepper(scene, HOLDING[name]), make_stepper(scene, HOLDING[name])
    assert isinstance(sweeps, Settling)
    steepest = (scene.chute.sin - scene.resistance) * scene.cells.dx / scene.beta
    pile = 1.0 + steepest * np.arange(nx) - min(steepest, 0.0) * nx
    wild = dice.random(nx) * (dice.random(nx) > 0.2) * np.where(dice.random(nx) < 0.1, 1e-300, 1.0)
    creeping = dice.choice([0.0, 1e-9, 1e-3], nx) * dice.normal(size=nx)
    for h, u in ((wild, dice.normal(size=nx)), (wild, creeping), (pile, np.zeros(nx)), (pile, creeping)):
        q = h * u * (dice.random(nx) > 0.2)
        same_step(sweeps, rooms, h, q, HELD)
        for side in ("h_left", "u_left", "h_right", "u_right"):
            np.testing.assert_array_equal(getattr(sweeps.now.balanced, side), getattr(rooms.now.balanced, side), side)
    assert nx < 50 or rooms.now.theta.any()
