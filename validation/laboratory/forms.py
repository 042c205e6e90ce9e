"""Five kinetic forms of (13) in one prototype, on velocity nodes and in closed form.

Only what a comparison of the forms needs: one scheme of first order, upwind transport (19), the force of each form,
projection. Where friction holds mass at rest is left out. The state is (w h, w h u), with w = beta in the form of (14)
and w = 1 in that of (13).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from kinsim.kinetic.equilibrium import fill, weights
from kinsim.kinetic.velocity import Grid
from kinsim.macroscopic.closed_form import ClosedForm, half_moments_of_cells
from kinsim.mean import mean_velocity
from kinsim.method import EquilibriumName
from kinsim.smooth.affine import affine_map
from kinsim.smooth.riccati import riccati
from laboratory.bend import Bend

Array = NDArray[np.float64]


class Form(Protocol):
    """How a force acts on the moments (rho, m) or (h, q) of a density."""

    @property
    def scaled(self) -> bool:
        """Whether the density is that of rho, w = beta."""

    def of_equilibrium(self, bend: Bend, h: Array, u: Array, g: Array, dt: float) -> tuple[Array, Array]:
        """What mass and velocity become: factor of the mass, new momentum over the old mass."""

    def of_nodes(self, bend: Bend, h: Array, u: Array, g: Array, dt: float, xi: Array) -> tuple[Array, Array]:
        """What a particle at each node counts for after the force, in mass and in momentum, shape (cells, nodes)."""


@dataclass(frozen=True)
class Advected:
    """(17): values of M are carried along Riccati's map, in (rho, m)."""

    scaled: bool = True

    def of_equilibrium(self, bend: Bend, h: Array, u: Array, g: Array, dt: float) -> tuple[Array, Array]:
        rho = bend.beta[1:-1] * h
        safe = np.where(rho > 0.0, rho, 1.0)
        after, m = riccati(safe, u, bend.gamma, g, 0.5, dt).carried(safe, u)
        return after / safe, m / safe

    def of_nodes(self, bend: Bend, h: Array, u: Array, g: Array, dt: float, xi: Array) -> tuple[Array, Array]:
        rho = bend.beta[1:-1] * h
        phi = riccati(*(a[:, None] for a in (rho, u, bend.gamma, g)), 0.5, dt)
        slope = phi.slope(xi)
        return slope, phi(xi) * slope


@dataclass(frozen=True)
class Affine:
    """(17) with the affine force in place of its own."""

    scaled: bool = True

    def of_equilibrium(self, bend: Bend, h: Array, u: Array, g: Array, dt: float) -> tuple[Array, Array]:
        return affine_map(bend.beta[1:-1] * h, u, bend.gamma, g, dt).carried(np.ones_like(h), u)

    def of_nodes(self, bend: Bend, h: Array, u: Array, g: Array, dt: float, xi: Array) -> tuple[Array, Array]:
        phi = affine_map(*(a[:, None] for a in (bend.beta[1:-1] * h, u, bend.gamma, g)), dt)
        return phi.slope(xi), phi(xi) * phi.slope(xi)


@dataclass(frozen=True)
class Pushed:
    """The family F_c: particles of h are pushed, each cell with its own beta; c = 0 is the rigid shift."""

    c: float
    scaled: bool = False

    def of_equilibrium(self, bend: Bend, h: Array, u: Array, g: Array, dt: float) -> tuple[Array, Array]:
        rho = bend.beta[1:-1] * h
        return np.ones_like(h), riccati(rho, u, bend.gamma, g, self.c, dt).pushed(rho, u)

    def of_nodes(self, bend: Bend, h: Array, u: Array, g: Array, dt: float, xi: Array) -> tuple[Array, Array]:
        phi = riccati(*(a[:, None] for a in (bend.beta[1:-1] * h, u, bend.gamma, g)), self.c, dt)
        return np.ones((h.size, xi.size)), phi(xi)


FORMS: dict[str, Form] = {
    "(17)": Advected(),
    "affine force": Affine(),
    "F_c, c = 1/2": Pushed(0.5),
    "F_c, c = 1/3": Pushed(1.0 / 3.0),
    "rigid shift": Pushed(0.0),
}


@dataclass(frozen=True)
class Closed:
    """Half-range moments in closed form; the force as it acts on an equilibrium, or on moments where that is enough."""

    def transport(self, bend: Bend, w: Array, h: Array, u: Array, dt: float) -> tuple[Array, Array, None]:
        m1, m2, n1, n2 = half_moments(bend.beta * h, u) * (w / bend.beta)
        return m1[:-1] + n1[1:], m2[:-1] + n2[1:], None

    def force(self, form: Form, bend: Bend, f: None, h: Array, u: Array, g: Array, dt: float) -> tuple[Array, Array]:
        return form.of_equilibrium(bend, h, u, g, dt)


CLOSED = Closed()


def half_moments(rho: Array, u: Array) -> Array:
    """I1..I4 with beta = 1, shape (4, cells)."""
    found = np.empty((4, rho.size))
    half_moments_of_cells(ClosedForm(), np.ascontiguousarray(rho), np.ascontiguousarray(u), np.ones(rho.size), found)
    return found


@dataclass(frozen=True)
class OnNodes:
    """Cell averages of M on velocity nodes, with sums only of what fluxes and force change.

    Attributes:
        grid: The nodes.
        projected: Whether what leaves transport is projected before the force.
        weights: Whose weights the fluxes have: xi_j^2 - dxi^2/12 of "cell-average", or xi_j^2 of "sampled".
    """

    grid: Grid
    projected: bool = False
    weights: EquilibriumName = "cell-average"

    def rows(self, rho: Array, u: Array) -> Array:
        return fill("cell-average", rho, u, rho, u, 1.0, self.grid)

    def transport(self, bend: Bend, w: Array, h: Array, u: Array, dt: float) -> tuple[Array, Array, Array]:
        M = self.rows(bend.beta * h, u) * (w / bend.beta)[:, None]
        half, xi = self.grid.half, self.grid.xi
        w1, w2 = weights(self.weights, self.grid)
        face = np.concatenate([M[1:, :half], M[:-1, half:]], axis=1)
        F1 = face[:, half:] @ w1 - face[:, half - 1 :: -1] @ w1
        F2 = face[:, half:] @ w2 + face[:, half - 1 :: -1] @ w2
        return F1, F2, M[1:-1] - dt / bend.dx * xi * np.diff(face, axis=0)

    def force(self, form: Form, bend: Bend, f: Array, h: Array, u: Array, g: Array, dt: float) -> tuple[Array, Array]:
        if self.projected:
            f = self.rows(bend.beta[1:-1] * h, u)
        f = f / np.maximum(f.sum(axis=1), 1e-300)[:, None]
        xi = self.grid.xi
        mass, momentum = form.of_nodes(bend, h, u, g, dt, xi)
        return 1.0 + (f * (mass - 1.0)).sum(axis=1), u + (f * (momentum - xi)).sum(axis=1)


@dataclass(frozen=True)
class Track:
    """What is kept of a run: times, total of h dx at each, final h and u."""

    t: Array
    mass: Array
    h: Array
    u: Array

    @property
    def drift(self) -> Array:
        """Relative change of the mass."""
        return (self.mass - self.mass[0]) / self.mass[0]


def march(form: Form, wing: Closed | OnNodes, bend: Bend, h: Array, u: Array, dt: float, steps: int) -> Track:
    """`steps` steps of `dt`; walls at both ends."""
    w = bend.beta if form.scaled else np.ones_like(bend.beta)
    inner, lam = w[1:-1], dt / bend.dx
    mass = [math.fsum(h) * bend.dx]
    for _ in range(steps):
        wide_h, wide_u = np.pad(h, 1, "edge"), np.concatenate([-u[:1], u, -u[-1:]])
        F1, F2, f = wing.transport(bend, w, wide_h, wide_u, dt)
        a, m = inner * h - lam * np.diff(F1), inner * h * u - lam * np.diff(F2)
        u = mean_velocity(m, a)
        pulled = u + dt * bend.pull
        held = np.copysign(np.maximum(np.abs(pulled) - dt * bend.resistance, 0.0), pulled)
        factor, u = wing.force(form, bend, f, a / inner, u, (held - u) / dt, dt)
        h = a * factor / inner
        u = u / factor
        mass.append(math.fsum(h) * bend.dx)
    return Track(dt * np.arange(steps + 1), np.array(mass), h, u)
