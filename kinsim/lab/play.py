"""A scene that is stepped by hand: a whole step, or one of its three stages at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, Literal, get_args

import numpy as np

from ..arrays import Array
from ..diagnostics.dump import SHOWN
from ..diagnostics.history import Cadence
from ..errors import InputError
from ..exact.of_scene import exact_of
from ..kinetic.equilibrium import fill
from ..mean import mean_velocity
from ..method import Kinetic, Macroscopic
from ..model.ground import Flat
from ..read import SceneFile
from ..run import Verdict
from ..scene import Scene
from ..simulate import find_bound
from ..simulation import Simulation
from ..solver.density import Density
from ..solver.solver import Solver
from ..solver.stages import Stages

Stage = Literal["transport", "force", "projection"]

STAGES: tuple[Stage, ...] = get_args(Stage)

NEVER = 2**62


@dataclass(frozen=True, eq=False)
class Moment:
    """What there is at a stage of a step; cells (nx,), densities (nx, n); not-a-number where there is none.

    Attributes:
        step, t: How many steps led here, and when that is.
        stage: After which stage of the last step; "projection" at the start.
        h, u: Mass and mean velocity of the density, u being no number on dry ground.
        twin_h, twin_u: The same of the closed-form twin.
        exact_h, exact_u: Of the exact solution, after whole steps, where there is one.
        xi, f: Nodes, shape (n,), and the density.
        offset: By so much the force moved the nodes of each row, shape (nx,).
        face_h, face_u: The state from which the fluxes at the faces come: the one before the step, or after it.
    """

    step: int
    t: float
    stage: Stage
    h: Array
    u: Array
    twin_h: Array
    twin_u: Array
    exact_h: Array | None
    exact_u: Array | None
    xi: Array
    f: Array
    offset: Array
    face_h: Array
    face_u: Array


class Twin:
    """The closed-form scheme that follows with the same steps."""

    def __init__(self, scene: Scene, method: Macroscopic) -> None:
        self.h, self.q = scene.initial()
        self.qhat = self.q
        self._solver = Solver(scene, method)

    def follow(self, dt: float) -> None:
        """Take a step of this length."""
        stages = self._solver.stages(self.h, self.q, dt)
        self.h, self.q, self.qhat = stages["h1"], stages["q1"], stages["qhat"]


class Play:
    """The run of `simulate`, a step when it is asked for, with the stages of the last step at hand.

    Attributes:
        file: The scene, its method and its clock.
        method: The method with the velocity window that `simulate` would take.
        stage: The stage that is looked at.
        verdict: How it ended, once it has.
    """

    @np.errstate(all="ignore")
    def __init__(self, file: SceneFile, stage: Stage = "force") -> None:
        assert isinstance(file.method, Kinetic)
        self.file, self.scene, self.stage = file, file.scene, stage
        self.method = file.method.within(find_bound(self.scene, file.method, file.clock))
        self.exact = exact_of(self.scene)
        self.verdict: Verdict | None = None
        self.twin = Twin(self.scene, self.method.twin)
        told_apart = self.method.order == 1 and isinstance(self.scene.ground, Flat)
        cadence = Cadence(file.clock, NEVER, None, None)
        self.simulation = Simulation(self.scene, self.method, file.clock, cadence, causes=told_apart)
        self.simulation.start()
        self.verdict = self.simulation.verdict

    @property
    def solver(self) -> Solver:
        """Where the run stands."""
        return self.simulation.solver

    @property
    def stages(self) -> Stages:
        """The last step, or before any one that nobody takes."""
        solver = self.solver
        return solver.last_stages if solver.step else solver.stages(solver.h, solver.q, 1e-3 * self.scene.cells.dx)

    @property
    def density(self) -> Density:
        """The density, at all stages of the last step."""
        return self.stages.density

    def takes_balanced(self, cell: int) -> bool:
        """Whether a cell took the balanced face (25) at its right wall in the last step of scheme 3."""
        slow = self.stages["slow"]
        return bool(slow[cell]) and (self.method.coupling == "cell" or bool(slow[cell + 1]))

    @property
    def step(self) -> int:
        """Whole steps so far."""
        return self.solver.step

    @property
    def end(self) -> float:
        """When the clock ends."""
        return self.file.clock.end

    @np.errstate(all="ignore")
    def advance(self) -> bool:
        """Take a whole step; False if the run is over."""
        if self.verdict is not None:
            return False
        before = self.step
        if self.simulation.verdict is None:
            self.simulation.advance(1)
        if self.step == before:
            self.verdict = self.simulation.verdict
            return False
        self.twin.follow(float(self.simulation.dts[-1][-1]))
        return True

    def next_stage(self) -> bool:
        """Go on to the next stage, with a new step after the last one; False if the run is over."""
        if self.verdict is not None:
            return False
        fresh = self.step == 0 or self.stage == STAGES[-1]
        if fresh and not self.advance():
            return False
        self.stage = STAGES[0] if fresh else STAGES[STAGES.index(self.stage) + 1]
        return True

    @np.errstate(all="ignore")
    def moment(self) -> Moment:
        """What is to be seen now; arrays of its own."""
        solver, twin = self.solver, self.twin
        stage: Stage = self.stage if self.step and self.verdict is None else "projection"
        h, q, twin_q, offset = solver.h, solver.q, twin.q, np.zeros_like(solver.h)
        face_h, face_u = h, mean_velocity(q, h)
        if stage == "projection":
            f = self.equilibrium(h, mean_velocity(q, h))
        else:
            f = SHOWN[stage](self.density)
            face_h, face_u = self.stages["h"], self.stages["u"]
        if stage == "transport":
            q, twin_q = self.stages["qhat"], twin.qhat
        if stage == "force":
            offset = self.density.offset
        exact = (None, None) if stage == "transport" else self._exact(solver.t)
        return Moment(
            step=self.step, t=solver.t, stage=stage, h=h.copy(), u=_seen(q, h),
            twin_h=twin.h, twin_u=_seen(twin_q, twin.h), exact_h=exact[0], exact_u=exact[1],
            xi=self.density.xi, f=f.copy(), offset=offset.copy(), face_h=face_h.copy(), face_u=face_u.copy(),
        )  # fmt: skip

    def equilibrium(self, h: Array, u: Array) -> Array:
        """M(h, xi - u) on the velocity nodes, shape (h.size, n)."""
        return self.face_rows(h, u, h, u, self.scene.beta)

    def face_rows(self, h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Any) -> Array:
        """M on the nodes with xi > 0 from the left states and xi < 0 from the right ones, shape (h.size, n)."""
        return fill(self.method.equilibrium, h_left, u_left, h_right, u_right, beta, self.density.grid)

    def _exact(self, t: float) -> tuple[Array | None, Array | None]:
        if self.exact is None:
            return None, None
        try:
            h, u = self.exact(self.scene.x, t)
        except InputError:  # it is known up to a time only
            return None, None
        return h, np.where(h > 0.0, u, np.nan)


def _seen(q: Array, h: Array) -> Array:
    return np.divide(q, h, out=np.full_like(q, np.nan), where=h > 0.0)
