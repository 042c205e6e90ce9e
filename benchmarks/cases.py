"""What is timed: the same breaking dam everywhere, in steps so short that it stays where it is."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinsim import Cells, ConstantSlope, Coulomb, Fixed, Kinetic, Macroscopic, Profile, Scene, Uniform
from kinsim.method import SchemeNumber
from kinsim.solver.solver import Solver

Array = NDArray[np.float64]
Call = Callable[[], object]

SHORT, MANY = 1e-9, 10**9
"""Steps that are timed: their length over that of a case, and more than there are."""

TOGETHER = 50_000
"""Cells that a call steps at least: a run marches many steps between two looks from outside."""


@dataclass(frozen=True)
class Case:
    """A scene, its state (h, q) with u of both signs, fast and slow, and a step within (28)."""

    scene: Scene
    h: Array
    q: Array
    dt: float
    bound: float

    @classmethod
    def dam(cls, nx: int) -> Case:
        """A dam that broke a while ago, under friction on a slope, on `nx` cells."""
        cells = Cells(-6.0, 6.0, nx)
        x = cells.x
        h = 0.75 - 0.25 * np.tanh(2.0 * x) + 0.05 * np.sin(3.0 * x)
        u = 0.35 * np.exp(-(x**2)) - 0.1 * np.cos(2.0 * x) * np.exp(-((x - 1.0) ** 2))
        heap = Profile(h, u)
        scene = Scene(cells, heap, ConstantSlope(0.1), Coulomb(0.3), epsilon=0.4)
        fastest = float(np.max(np.abs(u) + np.sqrt(2.0 * scene.beta * h)))
        return cls(scene, *scene.initial(), 0.8 * cells.dx / fastest, 1.05 * fastest)

    @property
    def force(self) -> tuple[float, float, float, float, float]:
        """beta, sin zeta, R, dx, dt."""
        scene = self.scene
        return scene.beta, scene.chute.sin, scene.resistance, scene.cells.dx, self.dt

    def on_grid(self, n: int, scheme: SchemeNumber = 1) -> Kinetic:
        """The method that carries f on `n` sampled nodes."""
        return Kinetic(scheme, Uniform(n, self.bound), "sampled")


class Step:
    """Steps of kinsim from the state of a case, as its time loop takes them; `steps` of them in a call."""

    def __init__(self, case: Case, method: Kinetic | Macroscopic) -> None:
        self._case, self.method = case, method
        self.solver, self.clock = Solver(case.scene, method), Fixed(SHORT * case.dt, MANY)
        self.steps = max(1, TOGETHER // case.h.size)
        self.solver.put(case.h, case.q)
        self()

    def __call__(self) -> None:
        self.solver.march(self.clock, self.steps)

    def result(self) -> list[Array]:
        """h and q after the step of the case, and f if there is a grid."""
        solver = Solver(self._case.scene, self.method)
        solver.put(self._case.h, self._case.q)
        solver.march(Fixed(self._case.dt, 1), 1)
        found = [solver.h.copy(), solver.q.copy()]
        return [*found, solver.last_stages.density.f] if solver.grid else found

    def of_stages(self) -> list[Array]:
        """The same out of all stages as arrays, which define the step."""
        stages = Solver(self._case.scene, self.method).stages(self._case.h, self._case.q, self._case.dt)
        found = [stages["h1"], stages["q1"]]
        return [*found, stages.density.f] if stages.solver.grid and stages.density.M.size else found


class Looked(Step):
    """The same, where somebody looks at f after each step."""

    f: Array

    def __init__(self, case: Case, method: Kinetic | Macroscopic) -> None:
        super().__init__(case, method)
        self.steps = 1

    def __call__(self) -> None:
        super().__call__()
        self.f = self.solver.last_stages.density.f


def stored(case: Case, n: int, scheme: SchemeNumber = 1) -> Step:
    """f on `n` sampled nodes, asked for in each step."""
    return Looked(case, case.on_grid(n, scheme))


def bare(case: Case, n: int) -> Step:
    """The same nodes, but f is not asked for."""
    return Step(case, case.on_grid(n))
