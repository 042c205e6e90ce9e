"""The kinetic entropy of a step, cell by cell: what transport and projection dissipate, and what the forces do.

M of (12) minimises the integral of H(f, xi) = xi^2 f/2 + (pi^2 beta^2/6) f^3 among the densities with its height and
momentum, and int H(M) dxi = h u^2/2 + beta h^2/2. A transport with upwind faces is a mean of densities, H is convex,
and the projection lowers what is left: so where no face holds anything back, `production` is never positive. The force
moves f rigidly, which changes its entropy by J (qhat + q^{n+1})/(2 h^{n+1}), the work of gravity and of friction.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np

from ..arrays import Array, Local
from ..errors import InputError
from ..model.ground import Flat
from ..scene import Scene
from ..solver.step import Step


@dataclass(frozen=True)
class Entropy:
    """The entropy of one step in each cell, per length, each of shape (nx,); dimensionless.

    Attributes:
        before, after: h u^2/2 + beta h^2/2 at levels n and n + 1.
        outflow: What leaves through the two walls of the cell.
        production: after - before + outflow - gravity - friction, the dissipation of transport and projection.
        gravity, friction: Work of the pull and of the ground.
        free: Cells with no held face, where `production` <= 0 is proved, shape (nx,).
    """

    before: Array
    after: Array
    outflow: Array
    production: Array
    gravity: Array
    friction: Array
    free: np.ndarray


def entropy(scene: Scene, now: Step) -> Entropy:
    """The entropy of a step of first order of scheme 1 or 4 in closed form, with faces that hold or none.

    Raises:
        InputError: The step has other faces, or none of its own, or is one of another scene.
    """
    if now.h.size != scene.cells.count:
        raise InputError(
            f"entropy: the step has {now.h.size} cells, the scene {scene.cells.count}; give the step's own scene"
        )
    if not isinstance(scene.ground, Flat):
        raise InputError("entropy: the inequality is one of a constant slope; take a scene on one")
    if now.states is None:
        raise InputError(
            "entropy: the step has no single flux per face; take scheme 1, or scheme 4 of order 1 that holds"
        )
    beta, dt, lam = scene.ground.beta, now.dt, now.dt / scene.cells.dx
    flux = entropy_flux(now.states.h_left, now.states.u_left, beta)
    flux -= entropy_flux(now.states.h_right, -now.states.u_right, beta)
    outflow = lam * (flux[1:] - flux[:-1])
    before, moved, after = (
        of_state(h, q, beta) for h, q in ((now.h, now.h * now.u), (now.h1, now.qhat), (now.h1, now.q1))
    )
    gravity = 0.5 * dt * scene.ground.pull * (now.qhat + now.q1)
    shows = now.states
    held = (shows.h_left != now.upwind.h_left) | (shows.h_right != now.upwind.h_right)
    return Entropy(
        before, after, outflow, moved - before + outflow, gravity, after - moved - gravity, ~(held[:-1] | held[1:])
    )


def of_state(h: Array, q: Array, beta: Local) -> Array:
    """q^2/(2 h) + beta h^2/2, 0 where it is dry."""
    return np.divide(q * q, 2.0 * h, out=np.zeros_like(q), where=h > 0) + 0.5 * beta * h * h


@cache
def gauss(count: int) -> tuple[Array, Array]:
    """Gauss-Legendre nodes and weights on [-1, 1]."""
    return np.polynomial.legendre.leggauss(count)


def entropy_flux(h: Array, u: Array, beta: float) -> Array:
    """int over xi > 0 of xi H(M, xi), with xi = u + c sin t and 32 Gauss nodes in t; shape as h."""
    nodes, weights = gauss(32)
    c = np.sqrt(2.0 * beta * h)
    wet = h > 0
    start = np.arcsin(np.clip(np.divide(-u, c, out=np.full_like(u, 2.0), where=wet), -1.0, 1.0))
    half = 0.5 * (0.5 * np.pi - start)
    t = start[..., None] + half[..., None] * (1.0 + nodes)
    xi = u[..., None] + c[..., None] * np.sin(t)
    M = c[..., None] * np.cos(t) / (np.pi * beta)
    H = 0.5 * xi * xi * M + np.pi**2 * beta**2 / 6.0 * M**3
    total: Array = half * ((xi * H * c[..., None] * np.cos(t)) @ weights)
    return np.where(wet, total, 0.0)
