"""Between two times: the step from U^n to U^{n+1}, the same for both wings."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from .balance.scheme4 import Held, HeldSloped, Reflecting
from .balance.schemes import Scheme, Scheme1, Scheme2, Scheme3Cell, Scheme3Face, flat
from .balance.settle import settle, stand_held
from .balance.slide import ROOM, slide, stand
from .balance.stages import TOP, Array, Stages, reach
from .balance.update import mean_of_stages, update
from .balance.wing import Wing
from .errors import InputError
from .kinetic.choice import make_density, may_forget
from .kinetic.fitted import FittedMeasure
from .kinetic.project import PROJECTIONS, FluxDifference, Projection
from .kinetic.velocity import Fitted
from .kinetic.wing import Density
from .macroscopic.sweep import sweep
from .macroscopic.wing import ClosedForm
from .method import Kinetic, Macroscopic
from .model.boundary import shown, streams
from .model.ground import Flat
from .scene import Scene


class Books(NamedTuple):
    """What one step did to the mass (h times length), beyond moving it about."""

    inflow_left: float
    inflow_right: float
    coupling_drift: float
    window_loss: float
    mended: float


class Stepper:
    """A scene and a method with the arrays of a step: `begin` at U^n, then `advance` by dt to U^{n+1}.

    Attributes:
        now: The arrays of the step.
        density: The density of the kinetic wing on a grid, else None.
        limit: The largest Courant number, (28).
    """

    limit = 1.0

    def __init__(self, scene: Scene, method: Kinetic | Macroscopic) -> None:
        self.scene = scene
        self._dx, self._periodic = scene.cells.dx, scene.boundary == "periodic"
        self.scheme = make_scheme(method, scene)
        self._beta = scene.ground.shown(self.scheme.sloped)
        self.now = Stages.empty(scene.cells.count, self.scheme.sloped)
        self.density: Density | None = None
        self._fastest = 0.0
        self.projection: Projection = FluxDifference()
        self.wing: Wing
        if isinstance(method, Macroscopic):
            self.wing = ClosedForm(scene, self.scheme.sloped)
        elif isinstance(method.velocity, Fitted):
            self.wing = FittedMeasure(scene, self.scheme.sloped, method.velocity.count)
        else:
            self.projection = PROJECTIONS[method.projection]
            self.wing = self.density = make_density(scene, method, self.scheme)

    def begin(self, h: Array, q: Array, fastest: float = math.inf) -> float:
        """Stand at U^n = (h, q), each of shape (nx,); returns the fastest occupied velocity.

        Slopes that would make particles faster than `fastest` are left out.
        """
        self.now.begin(self.scene, h, q)  # u = q/h, ghosts
        self.scheme.prepare(self.now, fastest)
        self._fastest = self.wing.equilibrium(self.now)  # M(h, xi - u), (12)
        return self._fastest

    def advance(self, dt: float) -> Books:
        """From where `begin` stood to U^{n+1}, which is then in `now.h1`, `now.q1`."""
        now, scheme, wing, dx = self.now, self.scheme, self.wing, self._dx
        lam = dt / dx
        walls = scheme.fluxes(now, wing, dt)  # (19), (24), (25)
        left, right, created = update(now.h, now.q, *walls, lam, now.h1, now.qhat)  # U^n - lam (F_{i+1/2} - F_{i-1/2})
        wing.transport(now, lam)  # f^{n+1} before the shift, (23)
        made = self.projection.after_transport(now, self.density)
        made += scheme.impulse(now, wing.pulled(now), dt)  # dt g h^{n+1}, (21), (22)
        lost = wing.force(now)  # f(xi + dt g) <- f(xi), (23)
        made += self.projection.after_force(now, self.density)  # U^{n+1}, (20)
        if self._periodic:  # the two ends are one face
            left, right, created = 0.0, 0.0, created + left + right
        return Books(dt * left, dt * right, dt * created, dx * lost, dx * made)

    def reach(self) -> float:
        """The outermost velocity of the states at U^n, face states included."""
        if self.density is None and not self.scheme.uses_balanced:
            return self._fastest
        if self.density is not None and not self.scheme.sloped:
            return self.density.reach
        return reach(self.now, self._beta, self.scheme.uses_balanced)

    def rest(self, h_max: float) -> float:
        """The largest |q| of a mass at rest: rounding, or a thousandth of a velocity cell."""
        return 1e-3 * self.density.grid.dxi * h_max if self.density else 1e-12


class Sliding(Stepper):
    """Scheme 1 where U^{n+1} follows from fluxes: the same step to the bit, in fewer sweeps; see `balance.slide`."""

    def __init__(self, scene: Scene, method: Kinetic | Macroscopic) -> None:
        super().__init__(scene, method)
        self._ground = flat(scene).numbers
        self._ends = shown(scene.boundary, scene.cells.count)

    def begin(self, h: Array, q: Array, fastest: float = math.inf) -> float:
        """Stand at U^n."""
        now = self.now
        stand(h, q, *self._ends, now.h, now.u, now.q)
        self._fastest = self.wing.equilibrium(now)
        return self._fastest

    def advance(self, dt: float) -> Books:
        """From where `begin` stood to U^{n+1}, (24)."""
        now, F1 = self.now, self.now.F1
        self._fluxes()
        mended = self._dx * self._move(dt)
        self.wing.transport(now, dt / self._dx)
        lost = self._dx * self.wing.force(now)
        if self._periodic:
            return Books(0.0, 0.0, dt * (F1[0] - F1[-1]), lost, mended)
        return Books(dt * F1[0], -dt * F1[-1], 0.0, lost, mended)

    def _fluxes(self) -> None:
        self.wing.upwind_flux(self.now)

    def _move(self, dt: float) -> float:
        """The rest of the step; returns the mass that is mended, per dx."""
        now = self.now
        slide(now.h, now.u, now.q, now.F1, now.F2, *self._ground, dt, now.h1, now.qhat, now.J, now.q1, ROOM)
        return 0.0


class Swept(Sliding):
    """The same in closed form, where the fluxes are made when the step begins; see `macroscopic.sweep`."""

    def begin(self, h: Array, q: Array, fastest: float = math.inf) -> float:
        """Stand at U^n, and sum up what leaves the cells, (24)."""
        now = self.now
        self._fastest = sweep(h, q, self._ground[2], *self._ends, now.h, now.u, now.q, now.F1, now.F2, ROOM)
        return self._fastest

    def _fluxes(self) -> None:
        """They are there."""


class Settling(Sliding):
    """Scheme 4 alike, with faces that hold; see `balance.settle`."""

    def __init__(self, scene: Scene, method: Kinetic | Macroscopic) -> None:
        super().__init__(scene, method)
        now, to = self.now, self.now.balanced
        states = (to.h_left, to.u_left, to.h_right, to.u_right)
        faces = (now.e, now.theta, now.still)
        seen = (now.low, now.high)
        self._stand = (*self._ground, *self._ends, now.h, now.u, now.q, *faces, *states, now.held, *seen, TOP)
        fluxes = (now.F1, now.F2)
        self._before = (now.h, now.q, to.h_left, to.h_right, *faces, *seen, *fluxes, *self._ground, *self._ends[2:])

    def begin(self, h: Array, q: Array, fastest: float = math.inf) -> float:
        """Stand at U^n, and judge the faces."""
        self._fastest = stand_held(h, q, *self._stand)
        return self._fastest

    def _fluxes(self) -> None:
        self.wing.held_flux(self.now)

    def _move(self, dt: float) -> float:
        now = self.now
        return float(settle(*self._before, dt, now.h1, now.qhat, now.J, now.q1))


class Heun(Stepper):
    """Two steps, of which the second starts at the end of the first; their mean with U^n is of second order in dt.

    Each cell is two halves (see `balance.slopes`), and each half is emptied through one face: h and f stay positive up
    to the Courant number 1/2 of what the cells show. In the second stage cells that became faster than that lose their
    slopes. The limit leaves room for 2 percent, so that on fine cells none does. A step whose first stage becomes so
    fast that a second one would break (28) ends with the first.
    """

    limit = 0.49

    def __init__(self, scene: Scene, method: Kinetic | Macroscopic) -> None:
        super().__init__(scene, method)
        self._then = Stages.empty(scene.cells.count, self.scheme.sloped)
        self._M = np.zeros_like(self.density.M) if self.density else None

    def advance(self, dt: float) -> Books:
        now, then, density, dx = self.now, self._then, self.density, self._dx
        if density and self._M is not None:
            np.copyto(self._M, density.M)
        first = super().advance(dt)
        self.now = then
        spare = 0.5 * density.grid.dxi if density else 0.0
        speed = self.begin(now.h1, now.q1, 0.5 * dx / dt - spare)
        if speed * dt > dx:
            self._stand_again(now)
            return first
        second = super().advance(dt)
        of_then = (then.h1, then.q, then.q1, then.J, then.F1, then.F2)
        mean_of_stages(now.h, now.q, *of_then, now.h1, now.q1, now.qhat, now.J, now.F1, now.F2)
        if density and self._M is not None:
            density.average(self._M[1:-1])
        self._stand_again(now)
        return Books(*(0.5 * (a + b) for a, b in zip(first, second, strict=True)))

    def _stand_again(self, now: Stages) -> None:
        """Show the stages of U^n, from which the step started."""
        self.now = now
        if self.density and self._M is not None:
            np.copyto(self.density.M, self._M)


def make_scheme(method: Kinetic | Macroscopic, scene: Scene) -> Scheme:
    """The scheme of a method; without any force no cell is slow, so that scheme 3 is scheme 1."""
    if method.scheme != 4 and not isinstance(scene.ground, Flat):
        raise InputError(f"scheme {method.scheme} is made for a constant slope; on a smooth chute take scheme 4")
    if method.scheme == 4:
        if method.order == 2:
            return HeldSloped(scene, method.limiter)
        return Reflecting(scene) if method.statics == "reflect" else Held(scene)
    if method.scheme == 1 or (method.scheme == 3 and not scene.forced):
        return Scheme1(scene)
    if method.scheme == 2:
        return Scheme2(scene)
    return (Scheme3Cell if method.coupling == "cell" else Scheme3Face)(scene)


def largest_courant(method: Kinetic | Macroscopic) -> float:
    """The largest Courant number that a method may take, (28)."""
    return (Heun if method.order == 2 else Stepper).limit


def make_stepper(scene: Scene, method: Kinetic | Macroscopic) -> Stepper:
    """The stepper that the order of the method asks for."""
    if method.order == 2:
        return Heun(scene, method)
    scheme = make_scheme(method, scene)
    if not isinstance(scene.ground, Flat) or streams(scene.boundary):
        return Stepper(scene, method)
    gridless = isinstance(method, Macroscopic) or isinstance(method.velocity, Fitted)
    if type(scheme) is Held and gridless:
        return Settling(scene, method)
    if type(scheme) is not Scheme1:
        return Stepper(scene, method)
    if isinstance(method, Macroscopic):
        return Swept(scene, method)
    return (Sliding if gridless or may_forget(method, scheme) else Stepper)(scene, method)
