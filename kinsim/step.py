"""One time step, U^n -> U^{n+1}, the same for both wings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from .balance.interface import Faces
from .balance.schemes import balanced_faces, make_scheme
from .balance.stages import Array, Stages, fastest
from .balance.update import update
from .errors import InputError
from .kinetic.equilibrium import EQUILIBRIA, Status
from .kinetic.fitted import FittedMeasure
from .kinetic.force import FORCES
from .kinetic.project import PROJECTIONS, FluxDifference, Projection
from .kinetic.velocity import Fitted
from .kinetic.wing import Density
from .macroscopic.wing import ClosedForm
from .method import Kinetic, Macroscopic
from .scene import Scene


class Wing(Protocol):
    """How half-range moments come about."""

    def equilibrium(self, now: Stages) -> float:
        """M(h, xi - u), (12); returns the fastest velocity it occupies, which (28) bounds."""

    def half_moments(self, now: Stages) -> Array:
        """First and second moment of M over xi > 0, then over xi < 0, of each ghosted cell, shape (4, nx + 2)."""

    def upwind_flux(self, now: Stages) -> None:
        """Write F1, F2 from the upwind face states."""

    def balanced_flux(self, now: Stages) -> None:
        """Write B1, B2 from the balanced face states."""

    def transport(self, now: Stages, lam: float) -> None:
        """f after transport."""

    def pulled(self, now: Stages) -> Array:
        """The height that the force acts on, shape (nx,): h^{n+1} in (23), h^n in (18)."""

    def force(self, now: Stages) -> float:
        """f after the force; returns the mass that left the velocity window, per dx."""


class Books(NamedTuple):
    """What one step did to the mass (h times length), beyond moving it about."""

    inflow_left: float
    inflow_right: float
    coupling_drift: float
    window_loss: float


class Stepper:
    """A scene and a method with the arrays of a step: `begin` at U^n, then `advance` by dt to U^{n+1}.

    Attributes:
        now: The arrays of the step.
        density: The density of the kinetic wing on a grid, else None.
    """

    def __init__(self, scene: Scene, method: Kinetic | Macroscopic) -> None:
        self.scene = scene
        self.now = Stages.empty(scene.cells.count)
        self.scheme = make_scheme(method.scheme, method.coupling, scene)
        self.density: Density | None = None
        self.projection: Projection = FluxDifference()
        self.wing: Wing
        if isinstance(method, Macroscopic):
            self.wing = ClosedForm(scene)
        elif isinstance(method.velocity, Fitted):
            self.wing = FittedMeasure(scene, method.velocity.count)
        else:
            self.projection = PROJECTIONS[method.projection]
            self.wing = self.density = Density(
                scene, method.velocity, EQUILIBRIA[method.equilibrium], FORCES[method.force], self.scheme.uses_balanced
            )

    def begin(self, h: Array, q: Array) -> float:
        """Stand at U^n = (h, q), each of shape (nx,); returns the fastest occupied velocity."""
        self.now.begin(self.scene, h, q)  # u = q/h, ghosts
        return self.wing.equilibrium(self.now)  # M(h, xi - u), (12)

    def advance(self, dt: float) -> Books:
        """From where `begin` stood to U^{n+1}, which is then in `now.h1`, `now.q1`."""
        scene, now, scheme, wing = self.scene, self.now, self.scheme, self.wing
        dx = scene.cells.dx
        lam = dt / dx
        wing.upwind_flux(now)  # (19), (24)
        if scheme.uses_balanced:
            balanced_faces(now)  # (25)
            wing.balanced_flux(now)
        scheme.choose(scene, now, dt)
        left, right, created = update(
            now.h, now.q, now.F1, now.F2, now.B1, now.B2, now.at_left, now.at_right, lam, now.h1, now.qhat
        )  # U^n - lam (F_{i+1/2} - F_{i-1/2})
        wing.transport(now, lam)  # f^{n+1} before the shift, (23)
        self.projection.after_transport(now, self.density)
        scheme.impulse(scene, now, wing.pulled(now), dt)  # dt g h^{n+1}, (21), (22)
        lost = wing.force(now)  # f(xi + dt g) <- f(xi), (23)
        self.projection.after_force(now, self.density)  # U^{n+1}, (20)
        if scene.boundary == "periodic":  # the two ends are one face
            left, right, created = 0.0, 0.0, created + left + right
        return Books(dt * left, dt * right, dt * created, dx * lost)

    def reach(self) -> float:
        """The outermost velocity of the states at U^n, face states included."""
        return fastest(self.now.h, self.now.u, self.scene.beta, self.scheme.uses_balanced)

    def rest(self, h_max: float) -> float:
        """The largest |q| of a mass at rest: rounding, or a thousandth of a velocity cell."""
        return 1e-3 * self.density.grid.dxi * h_max if self.density else 1e-12


@dataclass(frozen=True)
class Step:
    """Every stage of one step as arrays; cells (nx,), faces (nx + 1,), densities (nx, n).

    Attributes:
        h, u: State at level n.
        upwind, balanced: Face states (19) and (25); `balanced` is None where the scheme has none.
        half: First and second moment of M over xi > 0, then over xi < 0, of each cell, shape (4, nx).
        flux: F1, F2 of the upwind states, shape (2, nx + 1).
        balanced_flux: The same of the balanced states, or None.
        slow: Cells in the first branch of schemes 2 and 3.
        h1, q1: State at level n + 1.
        qhat: Momentum before the impulse.
        impulse: J.
        xi: Velocity nodes, shape (n,); this and the densities below are None in closed form.
        M: Equilibrium at level n.
        f_transport, f_force: f after transport and after the force.
        offset: How far the force moved the nodes of each row of f, shape (nx,); 0 unless the shift is exact.
        status: How the equilibrium fared, ghosted rows.
        books: What the step did to the mass.
    """

    h: Array
    u: Array
    upwind: Faces
    balanced: Faces | None
    half: Array
    flux: Array
    balanced_flux: Array | None
    slow: np.ndarray
    h1: Array
    q1: Array
    qhat: Array
    impulse: Array
    xi: Array | None
    M: Array | None
    f_transport: Array | None
    f_force: Array | None
    offset: Array | None
    status: Status | None
    books: Books


def step(scene: Scene, method: Kinetic | Macroscopic, h: Array, q: Array, dt: float) -> Step:
    """One step without a run: every stage as arrays of its own.

    Args:
        scene: What happens; its heap is not used.
        method: How it is computed. A velocity grid without a bound is made to fit this step.
        h, q: State at level n, each of shape (nx,).
        dt: Time step.

    Raises:
        InputError: Wrong shapes, h < 0, values that are not finite, or dt <= 0.
    """
    h, q = (np.array(array, dtype=float) for array in (h, q))
    nx = scene.cells.count
    if h.shape != (nx,) or q.shape != (nx,):
        raise InputError(f"step: h has shape {h.shape} and q {q.shape}; both need {(nx,)}")
    if not (np.isfinite(h).all() and np.isfinite(q).all() and (h >= 0).all()):
        raise InputError("step: h must be finite and at least 0, q finite")
    if not (np.isfinite(dt) and dt > 0):
        raise InputError(f"step: dt = {dt} is not a positive number")
    if isinstance(method, Kinetic) and method.unbounded:
        probe = Stepper(scene, method.twin)
        probe.begin(h, q)
        probe.advance(dt)
        pushed = np.max(np.abs(probe.now.J) / np.where(probe.now.h1 > 0, probe.now.h1, np.inf))
        method = method.within(1.05 * (probe.reach() + pushed) or 1.0)
    stepper = Stepper(scene, method)
    stepper.begin(h, q)
    books = stepper.advance(dt)
    now, density = stepper.now, stepper.density
    balanced = stepper.scheme.uses_balanced
    return Step(
        h=now.h[1:-1], u=now.u[1:-1], upwind=now.upwind, balanced=now.balanced if balanced else None,
        half=stepper.wing.half_moments(now)[:, 1:-1], flux=np.array([now.F1, now.F2]),
        balanced_flux=np.array([now.B1, now.B2]) if balanced else None,
        slow=now.slow[1:-1], h1=now.h1, q1=now.q1, qhat=now.qhat, impulse=now.J,
        xi=density.xi if density else None, M=density.M[1:-1] if density else None,
        f_transport=density.transported if density else None, f_force=density.f if density else None,
        offset=density.offset if density else None, status=density.status if density else None, books=books,
    )  # fmt: skip
