"""Scenes at random: blocks and humps, wet and dry ground, flat and steep, frictionless to sticky."""

from __future__ import annotations

import math

import numpy as np

from kinsim import Blocks, Cells, ConstantSlope, Coulomb, Expression, Frictionless, Scene


def random_scene(rng: np.random.Generator, count: int) -> tuple[Scene, float]:
    """A scene of `count` cells, and the time to which it is worth a look."""
    bed = 0.0 if rng.random() < 0.4 else float(rng.uniform(0.05, 0.5))
    peak = float(rng.uniform(0.5, 2.5))
    width = float(rng.uniform(0.6, 1.5))
    shape = rng.integers(3)
    if shape == 0:
        heap: Blocks | Expression = Blocks((-width, width), (bed, bed + peak, bed))
    elif shape == 1:
        heap = Blocks((0.0,), (bed + peak, bed))
    else:
        lean = float(rng.uniform(-0.5, 0.5))
        heap = Expression(h=f"{bed} + max(0, {peak} * (1 - (x/{width})**2) * (1 + {lean} * x))")
    friction = Frictionless() if rng.random() < 0.2 else Coulomb(float(rng.uniform(0.02, math.pi / 5)))
    zeta = 0.0 if rng.random() < 0.3 else float(rng.uniform(0.0, math.pi / 5))
    scene = Scene(Cells(-6.0, 8.0, count), heap, ConstantSlope(zeta), friction, epsilon=float(rng.uniform(0.2, 1.0)))
    return scene, float(rng.uniform(1.0, 3.0))
