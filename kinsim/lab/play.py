"""A scene that is stepped by hand: a whole step, or one of its three stages at a time."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from ..balance.stages import Array
from ..errors import InputError
from ..exact.of_scene import exact_of
from ..kinetic.equilibrium import Status
from ..kinetic.wing import Density
from ..local import Sides
from ..mean import mean_velocity
from ..method import Kinetic, Macroscopic
from ..model.ground import Flat
from ..read import SceneFile
from ..run import Verdict
from ..scene import Scene
from ..simulate import Loop, find_bound
from ..stepper import make_stepper
from ..watch.dump import SHOWN, Dump

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
        self._stepper = make_stepper(scene, method)

    def follow(self, dt: float) -> None:
        """Take a step of this length."""
        now = self._stepper.now
        self._stepper.begin(self.h, self.q)
        self._stepper.advance(dt)
        self.h, self.q, self.qhat = now.h1.copy(), now.q1.copy(), now.qhat.copy()


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
        self.loop = Loop(self.scene, self.method, file.clock, save_every=NEVER, force=False)
        told_apart = self.loop.stepper.limit == 1.0 and isinstance(self.scene.ground, Flat)
        self.loop.watch([Dump(every=NEVER)], causes=told_apart)
        self.loop.start()
        self._steps = self.loop.steps()

    @property
    def density(self) -> Density:
        """The density, at all stages of the last step."""
        assert self.loop.stepper.density is not None
        return self.loop.stepper.density

    @property
    def step(self) -> int:
        """Whole steps so far."""
        return self.loop.step

    @property
    def end(self) -> float:
        """When the clock ends."""
        return self.file.clock.end

    @np.errstate(all="ignore")
    def advance(self) -> bool:
        """Take a whole step; False if the run is over."""
        if self.verdict is not None:
            return False
        try:
            next(self._steps)
        except StopIteration as end:
            self.verdict = end.value
            return False
        self.twin.follow(self.loop.dts[-1])
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
        loop, now, twin = self.loop, self.loop.stepper.now, self.twin
        stage: Stage = self.stage if self.step and self.verdict is None else "projection"
        h, q, twin_q, offset = loop.h, loop.q, twin.q, np.zeros_like(loop.h)
        face_h, face_u = h, mean_velocity(q, h)
        if stage == "projection":
            f = self.equilibrium(h, mean_velocity(q, h))
        else:
            f = SHOWN[stage](self.density, now)
            face_h, face_u = now.h[1:-1], now.u[1:-1]
        if stage == "transport":
            q, twin_q = now.qhat, twin.qhat
        if stage == "force":
            offset = self.density.offset
        exact = (None, None) if stage == "transport" else self._exact(loop.t)
        return Moment(
            step=self.step, t=loop.t, stage=stage, h=h.copy(), u=_seen(q, h),
            twin_h=twin.h, twin_u=_seen(twin_q, twin.h), exact_h=exact[0], exact_u=exact[1],
            xi=self.density.xi, f=f.copy(), offset=offset.copy(), face_h=face_h.copy(), face_u=face_u.copy(),
        )  # fmt: skip

    def equilibrium(self, h: Array, u: Array) -> Array:
        """M(h, xi - u) on the velocity nodes, shape (h.size, n)."""
        return self.face_rows(h, u, h, u, self.scene.beta)

    def face_rows(self, h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: Sides) -> Array:
        """M on the nodes with xi > 0 from the left states and xi < 0 from the right ones, shape (h.size, n)."""
        rows = np.zeros((h_left.size, self.density.grid.count))
        self.density.fill(h_left, u_left, h_right, u_right, beta, rows, Status.empty(h_left.size))
        return rows

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
