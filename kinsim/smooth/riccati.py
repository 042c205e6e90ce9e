"""Where the quadratic force takes particles in a step, and where it takes an equilibrium: closed forms.

With A and g frozen, d xi/dt = g + kappa (xi^2 - A) is a Riccati equation. With tau = kappa dt and B = g/kappa - A

    Phi(xi) = (C xi + B S)/(C - S xi),    C = cos(sqrt(B) tau),    S = sin(sqrt(B) tau)/sqrt(B),

hyperbolic for B < 0. C, S and B S are kept, which are regular at B = 0 and at kappa = 0, where Phi is the rigid shift.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array
from ..errors import InputError
from .forces import mean_square

Numbers = float | Array

STEEPEST = 0.2
"""Largest |gamma| dx: under |xi| dt <= dx the quadratic part of (17) then adds at most a ninth to a velocity."""


@dataclass(frozen=True)
class Riccati:
    """The map of a step, elementwise; C^2 + S BS = 1."""

    C: Array
    S: Array
    BS: Array

    def __call__(self, xi: Numbers) -> Array:
        """Phi(xi), for xi on this side of the pole: S xi < C."""
        xi = np.asarray(xi, dtype=float)
        return (self.C * xi + self.BS) / (self.C - self.S * xi)

    def slope(self, xi: Numbers) -> Array:
        """Phi'(xi) = (C - S xi)^-2."""
        return np.asarray((self.C - self.S * np.asarray(xi, dtype=float)) ** -2.0)

    def inverse(self, xi: Numbers) -> Array:
        """Where a particle came from."""
        xi = np.asarray(xi, dtype=float)
        return (self.C * xi - self.BS) / (self.C + self.S * xi)

    def carried(self, rho: Numbers, u: Numbers) -> tuple[Array, Array]:
        """rho and m after M_t + F M_xi = 0, where values of M are carried along, as by the force of (17).

        The moments of M(rho, Phi^-1(xi) - u): with a = C - u S and d = sqrt(a^2 - 2 rho S^2)

            rho+ = 2 rho/(d (a + d)),    m+ = (rho/S) (a + d - 2 C d^2)/(d^3 (a + d)),

        the latter without its cancellation of S.

        Raises:
            InputError: A particle of the equilibrium reaches infinite velocity.
        """
        rho = np.asarray(rho, dtype=float)
        a, d = self._ends(rho, u)
        turned = a * (self.C * u + self.BS) + rho * self.S * (2.0 * self.C - 1.0 / (a + d))
        return 2.0 * rho / (d * (a + d)), 2.0 * rho * turned / (d**3 * (a + d))

    def pushed(self, rho: Numbers, u: Numbers) -> Array:
        """u after f_t + (F f)_xi = 0, where particles are: mass stays, u+ is the mean of Phi under the equilibrium.

        u+ = (2/(a + d) - C)/S, without its cancellation of S.

        Raises:
            InputError: A particle of the equilibrium reaches infinite velocity.
        """
        rho = np.asarray(rho, dtype=float)
        a, d = self._ends(rho, u)
        return np.asarray(2.0 * (self.BS + self.C * u + self.C * rho * self.S / (a + d)) / (a + d))

    def _ends(self, rho: Array, u: Numbers) -> tuple[Array, Array]:
        a = self.C - np.asarray(u, dtype=float) * self.S
        square = a * a - 2.0 * rho * self.S * self.S
        if not np.all((a > 0.0) & (square > 0.0)):
            raise InputError("smooth chute: within a step some particles reach infinite velocity; take a shorter dt")
        return a, np.sqrt(square)


def riccati(rho: Numbers, u: Numbers, gamma: Numbers, g: Numbers, c: float, dt: float) -> Riccati:
    """The map of `quadratic` force F_c, with A, g and gamma of each cell frozen over `dt`.

    Args:
        rho: beta h, of which A = u^2 + rho/2.
        u: Velocities.
        gamma: beta'/beta.
        g: Total accelerations.
        c: Which of the family; 1/2 is (17), 0 the rigid shift.
        dt: The step.
    """
    rho, u, gamma, g = (np.asarray(given, dtype=float) for given in (rho, u, gamma, g))
    tau = c * gamma * dt
    start = g * dt - tau * mean_square(rho, u)
    angle, shape = _cosine(tau * start), _sine(tau * start)
    return Riccati(angle, tau * shape, start * shape)


def refuse_steep(gamma: Numbers, dx: float) -> None:
    """Let the cells resolve beta.

    Raises:
        InputError: |gamma| dx > `STEEPEST` in some cell.
    """
    steep = np.abs(np.atleast_1d(gamma)) * dx
    worst = int(np.argmax(steep))
    if not steep[worst] <= STEEPEST:
        raise InputError(
            f"smooth chute: |beta'/beta| dx = {steep[worst]:.3g} in cell {worst}, more than {STEEPEST}; "
            f"take cells of at most {dx * STEEPEST / steep[worst]:.3g}"
        )


def _cosine(square: Array) -> Array:
    """cos sqrt(x), cosh sqrt(-x) for x < 0."""
    root = np.sqrt(np.abs(square))
    return np.where(square < 0.0, np.cosh(np.where(square < 0.0, root, 0.0)), np.cos(root))


def _sine(square: Array) -> Array:
    """sin sqrt(x) / sqrt(x), sinh sqrt(-x) / sqrt(-x) for x < 0, 1 at 0."""
    root = np.sqrt(np.abs(square))
    below = np.where(square < 0.0, root, 0.0)
    return np.where(root > 0.0, np.where(square < 0.0, np.sinh(below), np.sin(root)), 1.0) / np.where(
        root > 0.0, root, 1.0
    )
