"""One time step with all its stages as arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .balance.interface import Faces
from .balance.scheme4 import Held
from .balance.schemes import Scheme1
from .balance.stages import Array
from .errors import InputError
from .kinetic.equilibrium import Status
from .method import Kinetic, Macroscopic
from .scene import Scene
from .stepper import Books, make_stepper


@dataclass(frozen=True)
class Step:
    """Every stage of one step as arrays; cells (nx,), faces (nx + 1,), densities (nx, n).

    Attributes:
        dt: How long the step is.
        h, u: State at level n.
        upwind, balanced: Face states (19), and (25) or the held ones of scheme 4; `balanced` is None where the scheme
            has none.
        states: The states of the one flux per face: `upwind` in scheme 1, held ones in scheme 4 of order 1, else None.
        half: First and second moment of M over xi > 0, then over xi < 0, of each cell, shape (4, nx).
        flux: F1, F2 of the upwind states, shape (2, nx + 1); in scheme 4 the flux that faces have.
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

    dt: float
    h: Array
    u: Array
    upwind: Faces
    balanced: Faces | None
    states: Faces | None
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


@np.errstate(all="ignore")
def step(scene: Scene, method: Kinetic | Macroscopic, h: Array, q: Array, dt: float) -> Step:
    """One step without a run: every stage as arrays of its own.

    Args:
        scene: What happens; its heap is not used.
        method: How it is computed. A velocity grid without a bound is made to fit this step.
        h, q: State at level n, each of shape (nx,).
        dt: Time step.

    Raises:
        InputError: Arguments of other kinds, wrong shapes, h < 0, values that are not finite, or dt <= 0.
    """
    if not (isinstance(scene, Scene) and isinstance(method, Kinetic | Macroscopic)):
        raise InputError(
            f"step: got {scene!r:.60} and {method!r:.60}; give a Scene, then a Kinetic or Macroscopic method"
        )
    h, q = (np.array(array, dtype=float) for array in (h, q))
    nx = scene.cells.count
    if h.shape != (nx,) or q.shape != (nx,):
        raise InputError(f"step: h has shape {h.shape} and q {q.shape}; both need {(nx,)}")
    if not (np.isfinite(h).all() and np.isfinite(q).all() and (h >= 0).all()):
        raise InputError("step: h must be finite and at least 0, q finite")
    if not (np.isfinite(dt) and dt > 0):
        raise InputError(f"step: dt = {dt} is not a positive number")
    if isinstance(method, Kinetic) and method.unbounded:
        probe = make_stepper(scene, method.twin)
        probe.begin(h, q)
        probe.advance(dt)
        pushed = np.max(np.abs(probe.now.J) / np.where(probe.now.h1 > 0, probe.now.h1, np.inf))
        method = method.within(1.05 * (probe.reach() + pushed) or 1.0)
    stepper = make_stepper(scene, method)
    stepper.begin(h, q)
    books = stepper.advance(dt)
    now, density = stepper.now, stepper.density
    scheme = stepper.scheme
    states = {Scheme1: now.upwind, Held: now.balanced}.get(type(scheme))
    return Step(
        dt=dt, h=now.h[1:-1], u=now.u[1:-1], upwind=now.upwind, balanced=now.balanced if scheme.has_faces else None,
        states=states,
        half=stepper.wing.half_moments(now)[:, 1:-1].copy(), flux=np.array([now.F1, now.F2]),
        balanced_flux=np.array([now.B1, now.B2]) if scheme.uses_balanced else None,
        slow=now.slow[1:-1], h1=now.h1, q1=now.q1, qhat=now.qhat, impulse=now.J,
        xi=density.xi if density else None, M=density.M[1:-1] if density else None,
        f_transport=density.transported if density else None, f_force=density.f if density else None,
        offset=density.offset if density else None, status=density.status if density else None, books=books,
    )  # fmt: skip
