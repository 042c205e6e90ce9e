"""A wavy chute, and masses that friction can hold on any chute, written by hand beside the tables of the schemes."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from kinsim import Cells, Coulomb, Profile, Scene, SlopeFormula, SmoothChute

Array = NDArray[np.float64]

WAVES = SlopeFormula("0.1 + 0.35*sin(x)", 0.5)
"""Between -14 and 26 degrees, periodic over 2 pi."""


def wavy(h: Array, u: Array | None = None, eta: float = 0.0, boundary: str = "wall", delta: float = 0.5) -> Scene:
    """A mass on a ring or between walls, on slopes between -14 and 26 degrees."""
    chute = SmoothChute(WAVES, eta)
    return Scene(Cells(0.0, 2.0 * math.pi, h.size), Profile(h, u), chute, Coulomb(delta), boundary, 0.4)


def admissible(scene: Scene, dice: np.random.Generator, first: float, share: float) -> Array:
    """Heights whose every jump friction balances with a random part of `share` of what it can give.

    beta_f (h' - h) + (beta' - beta)(h + h')/4 = dx (sin zeta_f - theta R_f), |theta| <= share, solved for h' from face
    to face; a mass that runs out may begin anew behind dry ground.
    """
    x, dx = scene.cells.x, scene.cells.dx
    at = scene.chute.zeta(0.5 * (x[1:] + x[:-1]))[0]
    beta = scene.epsilon * scene.k * np.cos(scene.chute.zeta(x)[0])
    h = [first]
    for i in range(x.size - 1):
        R = math.cos(at[i]) * math.tan(scene.friction.delta)
        middle, quarter = 0.5 * (beta[i] + beta[i + 1]), 0.25 * (beta[i + 1] - beta[i])
        slopes = math.sin(at[i]) - share * R * dice.uniform(-1.0, 1.0, 40)
        above = (h[-1] * (middle - quarter) + slopes * dx) / (middle + quarter)
        fits = above[above >= 0.0]
        h.append(fits[0] if fits.size and (h[-1] > 0.0 or dice.random() < 0.2) else 0.0)
    return np.array(h)
