"""One time step with all its stages as arrays."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..arrays import Array
from ..errors import InputError
from ..kinetic.equilibrium import Status
from ..macroscopic.closed_form import half_moments_of_cells
from ..method import Kinetic, Macroscopic
from ..scene import Scene
from ..schemes.questions import has_two_fluxes
from .march import REACH
from .solver import Solver
from .stages import Books, Stages


@dataclass(frozen=True)
class Faces:
    """Heights and velocities left and right of each face, each of shape (nx + 1,)."""

    h_left: Array
    u_left: Array
    h_right: Array
    u_right: Array


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
        status: How the equilibrium fared in each cell.
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
    slow: NDArray[np.bool_]
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

    @classmethod
    def of(cls, stages: Stages) -> Step:
        """The stages under their names in the paper."""
        solver = stages.solver
        method, sloped, scheme = solver.method, solver.method.order == 2, solver.method.scheme
        h, u = stages.ghosted("h"), stages.ghosted("u")
        plus = [stages.ghosted(name) for name in ("h_plus", "u_plus")] if sloped else [h, u]
        minus = [stages.ghosted(name) for name in ("h_minus", "u_minus")] if sloped else [h, u]
        upwind = Faces(plus[0][:-1], plus[1][:-1], minus[0][1:], minus[1][1:])
        two = has_two_fluxes(solver.model.scheme) and scheme != 4
        balanced = None
        if two:
            balanced = Faces(stages["h_mean"], u[:-1], stages["h_mean"], u[1:])
        elif scheme == 4 and method.statics == "hold":
            balanced = Faces(stages["h_left"], upwind.u_left, stages["h_right"], upwind.u_right)
        states = (
            balanced if scheme == 4 and not sloped else (upwind if scheme == 1 or not (two or scheme == 4) else None)
        )
        half = np.zeros((4, h.size - 2))
        betas = np.broadcast_to(np.asarray(solver.scene.beta, dtype=float), h[1:-1].shape).copy()
        if getattr(method, "flux", None) is None:
            half_moments_of_cells(solver.model.flux, h[1:-1], u[1:-1], betas, half)
        density = stages.density if solver.grid else None
        return cls(
            dt=stages.dt, h=h[1:-1], u=u[1:-1], upwind=upwind, balanced=balanced, states=states, half=half,
            flux=np.array([stages["W1"], stages["W2"]] if two else [stages["F1"], stages["F2"]]),
            balanced_flux=np.array([stages["B1"], stages["B2"]]) if two else None, slow=stages["slow"] == 1.0,
            h1=stages["h1"], q1=stages["q1"], qhat=stages["qhat"], impulse=stages["J"],
            xi=density.xi if density else None, M=density.M if density else None,
            f_transport=density.transported if density else None, f_force=density.f if density else None,
            offset=density.offset if density else None, status=stages.status, books=stages.books,
        )  # fmt: skip


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
        twin = Solver(scene, method.twin).stages(h, q, dt)
        pushed = np.max(np.abs(twin["J"]) / np.where(twin["h1"] > 0, twin["h1"], np.inf))
        method = method.within(1.05 * (float(twin.solver.seen[REACH]) + pushed) or 1.0)
    return Step.of(Solver(scene, method).stages(h, q, dt))
