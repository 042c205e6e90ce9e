"""Where the affine force takes particles in a step; the moments of *any* density follow from them alone."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..arrays import Array

Numbers = float | Array


@dataclass(frozen=True)
class AffineMap:
    """Phi(xi) = scale xi + offset, elementwise."""

    scale: Array
    offset: Array

    def __call__(self, xi: Numbers) -> Array:
        """Phi(xi)."""
        return np.asarray(self.scale * np.asarray(xi) + self.offset)

    def slope(self, xi: Numbers) -> Array:
        """Phi', the same for all xi."""
        return np.asarray(self.scale + 0.0 * np.asarray(xi))

    def carried(self, rho: Numbers, m: Numbers) -> tuple[Array, Array]:
        """rho and m after values of f are carried along, f(Phi(xi)) <- f(xi), whatever f is."""
        rho, m = np.asarray(rho, dtype=float), np.asarray(m, dtype=float)
        return self.scale * rho, self.scale * (self.scale * m + self.offset * rho)


def affine_map(rho: Numbers, u: Numbers, gamma: Numbers, g: Numbers, dt: float) -> AffineMap:
    """The map of d xi/dt = g + gamma rho/2 + gamma u (xi - u), with all but xi frozen over `dt`; arguments alike."""
    rho, u, gamma, g = (np.asarray(given, dtype=float) for given in (rho, u, gamma, g))
    turn = gamma * u * dt
    mean = np.where(turn != 0.0, np.expm1(turn) / np.where(turn != 0.0, turn, 1.0), 1.0)
    return AffineMap(np.exp(turn), (g + gamma * rho / 2.0) * dt * mean - u * np.expm1(turn))
