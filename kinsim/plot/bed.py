"""A chute as it stands: the bed in its true geometry, and the mass upon it, square to the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from ..arrays import Array
from ..model.chute import ConstantSlope, SmoothChute
from ..scene import Scene

SHARE = 0.09
"""The mass is drawn as high as this share of the length of the chute, or as it is if it is higher."""

LIFTED = {"color": "#d55e00", "linewidth": 3.0, "solid_capstyle": "butt"}
"""Okabe and Ito's vermillion, under the ground that the mass left."""


@dataclass(frozen=True, eq=False)
class Bed:
    """The ground of a scene.

    Attributes:
        across, down: Horizontal and vertical places of the faces, shape (nx + 1,), in units of x.
        normal: The direction square to the ground at the faces, shape (2, nx + 1).
        thickness: Heights are drawn so many times; epsilon of them would be true.
        factor: `thickness` over epsilon, which is 1, 2 or 5 times a power of ten.
    """

    across: Array
    down: Array
    normal: Array
    thickness: float
    factor: float

    @classmethod
    def of(cls, scene: Scene, highest: float) -> Bed:
        """The bed of `scene` on which masses up to `highest` are drawn."""
        face, middle = _angles(scene, scene.cells.faces), _angles(scene, scene.x)
        dx = scene.cells.dx
        across, down = (_summed(of(face), of(middle), dx) for of in (np.cos, np.sin))
        true = scene.epsilon * highest
        wanted = SHARE * math.hypot(across[-1], down[-1]) / true if true > 0.0 else 1.0
        factor = max(_round(wanted), 1.0)
        return cls(across, -down, np.array([np.sin(face), np.cos(face)]), factor * scene.epsilon, factor)

    def surface(self, h: Array) -> tuple[Array, Array]:
        """Where the surface of the mass of height h, shape (nx,), is drawn: at the faces, between their two cells."""
        at_faces = np.concatenate([h[:1], 0.5 * (h[1:] + h[:-1]), h[-1:]])
        x, z = self.thickness * at_faces * self.normal
        return self.across + x, self.down + z

    def outline(self, h: Array) -> Array:
        """The corners of the mass, shape (2 nx + 2, 2): along its surface, and back along the ground."""
        x, z = self.surface(h)
        there, back = np.stack([x, z], axis=1), np.stack([self.across, self.down], axis=1)
        return np.concatenate([there, back[::-1]])

    @property
    def words(self) -> str:
        """How thick the mass is drawn."""
        return "thickness to scale" if self.factor == 1.0 else f"thickness drawn {self.factor:g} times to scale"

    def draw(self, axes: Any) -> None:
        """The ground alone."""
        axes.plot(self.across, self.down, color="0.25", linewidth=1.4)
        low = min(self.down.min(), 0.0) - 0.02 * (self.across[-1] - self.across[0])
        axes.fill_between(self.across, self.down, low, color="0.9", linewidth=0.0)
        axes.set_aspect("equal", adjustable="box")
        axes.set_xlabel("horizontal")
        axes.set_ylabel("vertical")

    def mark(self, axes: Any, scene: Scene, begin: float, end: float, label: str) -> None:
        """Underline the ground between the places `begin` and `end` along the chute."""
        faces = scene.cells.faces
        here = (faces >= begin - 0.51 * scene.cells.dx) & (faces <= end + 0.51 * scene.cells.dx)
        axes.plot(self.across[here], self.down[here], label=label, **LIFTED)


def curved(scene: Scene) -> bool:
    """Whether a scene has a bed to be shown."""
    return isinstance(scene.chute, SmoothChute)


def _angles(scene: Scene, x: Array) -> Array:
    chute = scene.chute
    return np.full(x.size, chute.zeta) if isinstance(chute, ConstantSlope) else chute.zeta(x)[0]


def _summed(face: Array, middle: Array, dx: float) -> Array:
    """Integrals from the first face, by Simpson's rule in each cell."""
    return np.concatenate([[0.0], np.cumsum(dx / 6.0 * (face[:-1] + 4.0 * middle + face[1:]))])


def _round(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above `value`."""
    power = 10.0 ** math.floor(math.log10(value))
    return power * max(step for step in (1.0, 2.0, 5.0) if step * power <= value * (1.0 + 1e-12))
