"""One time step, U^n -> U^{n+1}, the same for both wings."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np

from .balance.interface import Faces
from .balance.schemes import balanced_faces, make_scheme
from .balance.stages import Array, Stages
from .balance.update import update
from .errors import InputError
from .kernel import kernel
from .kinetic.equilibrium import EQUILIBRIA
from .kinetic.wing import Density
from .macroscopic.wing import ClosedForm
from .method import Kinetic, Macroscopic
from .scene import Scene


class Wing(Protocol):
    """How half-range moments come about."""

    def equilibrium(self, now: Stages) -> None:
        """M(h, xi - u), (12)."""

    def upwind_flux(self, now: Stages) -> None:
        """Write F1, F2 from the upwind face states."""

    def balanced_flux(self, now: Stages) -> None:
        """Write B1, B2 from the balanced face states."""

    def transport(self, now: Stages, lam: float) -> None:
        """f after transport."""

    def force(self, now: Stages) -> float:
        """f after the force; returns the mass that left the velocity window, per dx."""


class Books(NamedTuple):
    """What one step did to the mass (h times length), beyond moving it about."""

    inflow_left: float
    inflow_right: float
    coupling_drift: float
    window_loss: float


class Stepper:
    """A scene and a method with the arrays of a step; call it with U^n and dt to get U^{n+1}."""

    def __init__(self, scene: Scene, method: Kinetic | Macroscopic) -> None:
        self.scene = scene
        self.method = method
        self.now = Stages.empty(scene.cells.count)
        self.scheme = make_scheme(method.scheme, method.coupling, scene)
        self.density: Density | None = None
        self.wing: Wing
        if isinstance(method, Kinetic):
            grid, equilibrium = method.velocity.grid(), EQUILIBRIA[method.equilibrium]
            self.wing = self.density = Density(scene, grid, equilibrium, self.scheme.uses_balanced)
        else:
            self.wing = ClosedForm(scene)

    def __call__(self, h: Array, q: Array, dt: float) -> Books:
        """Advance (h, q), each of shape (nx,), by dt; the result stands in `now.h1`, `now.q1`."""
        scene, now, scheme, wing = self.scene, self.now, self.scheme, self.wing
        dx = scene.cells.dx
        lam = dt / dx
        now.begin(scene, h, q)  # u = q/h, ghosts
        wing.equilibrium(now)  # M(h, xi - u), (12)
        wing.upwind_flux(now)  # (19), (24)
        if scheme.uses_balanced:
            balanced_faces(now)  # (25)
            wing.balanced_flux(now)
        scheme.choose(scene, now, dt)
        left, right, created = update(
            h, q, now.F1, now.F2, now.B1, now.B2, now.at_left, now.at_right, lam, now.h1, now.qhat
        )  # U^n - lam (F_{i+1/2} - F_{i-1/2})
        wing.transport(now, lam)  # f^{n+1} before the shift, (23)
        scheme.impulse(scene, now, dt)  # dt g h^{n+1}, (21), (22)
        lost = wing.force(now)  # f(xi + dt g) <- f(xi), (23)
        np.add(now.qhat, now.J, out=now.q1)  # U^{n+1}, (20)
        if scene.boundary == "periodic":  # the two ends are one face
            left, right, created = 0.0, 0.0, created + left + right
        return Books(dt * left, dt * right, dt * created, dx * lost)

    def reach(self) -> float:
        """The outermost velocity that M and the densities at faces occupy, at the level the last step began with."""
        return fastest_states(self.now.h, self.now.u, self.scene.beta, self.scheme.uses_balanced)


@kernel
def fastest_states(h: Array, u: Array, beta: float, faces: bool) -> float:
    """max(|u| + sqrt(2 beta h)) over the cells and, with `faces`, over the face states (25); h, u are ghosted."""
    top = 0.0
    for i in range(h.size):
        if h[i] > 0.0:
            top = max(top, abs(u[i]) + np.sqrt(2.0 * beta * h[i]))
        if faces and i > 0:
            mean = max(0.5 * (h[i - 1] + h[i]), 0.0)
            top = max(top, max(abs(u[i - 1]), abs(u[i])) + np.sqrt(2.0 * beta * mean))
    return top


@dataclass(frozen=True)
class Step:
    """Every stage of one step as arrays; cells (nx,), faces (nx + 1,), densities (nx, n).

    Attributes:
        h, u: State at level n.
        upwind, balanced: Face states (19) and (25); `balanced` is None where the scheme has none.
        flux: F1, F2 of the upwind states, shape (2, nx + 1).
        balanced_flux: The same of the balanced states, or None.
        slow: Cells in the first branch of schemes 2 and 3.
        h1, q1: State at level n + 1.
        qhat: Momentum before the impulse.
        impulse: J.
        xi: Velocity nodes, shape (n,); this and the densities below are None in closed form.
        M: Equilibrium at level n.
        f_transport, f_force: f after transport and after the force.
        books: What the step did to the mass.
    """

    h: Array
    u: Array
    upwind: Faces
    balanced: Faces | None
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
    if isinstance(method, Kinetic) and method.velocity.bound is None:
        probe = Stepper(scene, method.twin)
        probe(h, q, dt)
        pushed = np.max(np.abs(probe.now.J) / np.where(probe.now.h1 > 0, probe.now.h1, np.inf))
        method = method.within(1.05 * (probe.reach() + pushed) or 1.0)
    stepper = Stepper(scene, method)
    books = stepper(h, q, dt)
    now, density = stepper.now, stepper.density
    balanced = stepper.scheme.uses_balanced
    return Step(
        h=now.h[1:-1], u=now.u[1:-1], upwind=now.upwind, balanced=now.balanced if balanced else None,
        flux=np.array([now.F1, now.F2]), balanced_flux=np.array([now.B1, now.B2]) if balanced else None,
        slow=now.slow[1:-1], h1=now.h1, q1=now.q1, qhat=now.qhat, impulse=now.J,
        xi=density.grid.xi if density else None, M=density.M[1:-1] if density else None,
        f_transport=density.transported if density else None, f_force=density.f if density else None, books=books,
    )  # fmt: skip
