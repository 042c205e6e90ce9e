"""What is timed: the same breaking dam everywhere, taken anew from the same state in each step."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from kinsim import Cells, ConstantSlope, Coulomb, Fitted, Kinetic, Macroscopic, Profile, Scene, Uniform
from kinsim.kinetic.equilibrium import EQUILIBRIA
from kinsim.kinetic.force import FORCES
from kinsim.kinetic.wing import Density
from kinsim.method import SchemeNumber
from kinsim.stepper import Stepper, make_stepper

Array = NDArray[np.float64]
Call = Callable[[], object]


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
    """One step of kinsim from the state of a case, as its time loop takes it."""

    stepper: Stepper

    def __init__(self, case: Case, method: Kinetic | Macroscopic) -> None:
        self._case, self.method = case, method
        self.stepper = self._make()
        self()

    def _make(self) -> Stepper:
        return make_stepper(self._case.scene, self.method)

    def __call__(self) -> None:
        case = self._case
        self.stepper.begin(case.h, case.q)
        self.stepper.advance(case.dt)

    def result(self) -> list[Array]:
        """h and q at level n + 1, and f where it is kept."""
        now, density = self.stepper.now, self.stepper.density
        return [now.h1.copy(), now.q1.copy()] + ([density.f.copy()] if density else [])

    def of_rooms(self) -> list[Array]:
        """The same by the rooms, which define the step."""
        return Rooms(self._case, self.method).result()


class Rooms(Step):
    """The same, stage by stage, where f is stored: what every faster path has to give."""

    def _make(self) -> Stepper:
        scene, method = self._case.scene, self.method
        stepper = Stepper(scene, method)
        if stepper.density and isinstance(method, Kinetic) and not isinstance(method.velocity, Fitted):
            how = EQUILIBRIA[method.equilibrium], FORCES[method.force]
            stepper.wing = stepper.density = Density(scene, method.velocity, *how, stepper.scheme)
        return stepper


class Looked(Step):
    """The same, where somebody looks at f after each step."""

    f: Array

    def __call__(self) -> None:
        super().__call__()
        assert self.stepper.density is not None
        self.f = self.stepper.density.f


def stored(case: Case, n: int, scheme: SchemeNumber = 1) -> Step:
    """f on `n` sampled nodes, asked for in each step."""
    return Looked(case, case.on_grid(n, scheme))


def bare(case: Case, n: int) -> Step:
    """The same nodes, but f is not asked for."""
    return Step(case, case.on_grid(n))
