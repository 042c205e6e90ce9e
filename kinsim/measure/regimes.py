"""Random states for every regime that a flux may meet."""

from __future__ import annotations

import numpy as np

from ..arrays import Array

States = tuple[Array, Array, Array, Array]


def regimes(dice: np.random.Generator, count: int, beta: float) -> dict[str, States]:
    """Random states (h_left, u_left, h_right, u_right), each of shape (count,), for every regime."""

    def height(low: float = -2.0, high: float = 1.0) -> Array:
        return 10.0 ** dice.uniform(low, high, count)

    def moving(h: Array, low: float, high: float, signs: tuple[int, ...] = (-1, 1)) -> Array:
        return dice.choice(signs, count) * dice.uniform(low, high, count) * np.sqrt(2.0 * beta * h)

    def near(h: Array) -> Array:
        a = 1.0 + dice.choice((-1, 1), count) * 10.0 ** dice.uniform(-12, -1, count)
        return dice.choice((-1, 1), count) * a * np.sqrt(2.0 * beta * h)

    def fast(h: Array) -> Array:
        return dice.choice((-1, 1), count) * 10.0 ** dice.uniform(0.0, 3.0, count) * np.sqrt(2.0 * beta * h)

    def either(first: Array, second: Array) -> Array:
        return np.where(dice.random(count) < 0.5, first, second)

    def shuffled(states: States) -> States:
        swap = dice.random(count) < 0.5
        hl, ul, hr, ur = states
        return np.where(swap, hr, hl), np.where(swap, ur, ul), np.where(swap, hl, hr), np.where(swap, ul, ur)

    h, k, thin = height(), height(), height(-12.0, -6.0)
    dry = np.zeros(count)
    film, other = height(-12.0, -2.0), either(height(-12.0, -2.0), height())
    return {
        "at rest": (h, dry.copy(), k, dry.copy()),
        "transonic": (h, moving(h, 0, 1), k, moving(k, 0, 1)),
        "supersonic to the right": (h, moving(h, 1, 4, (1,)), k, moving(k, 1, 4, (1,))),
        "supersonic to the left": (h, moving(h, 1, 4, (-1,)), k, moving(k, 1, 4, (-1,))),
        "parting and colliding": (h, moving(h, 1, 4), k, moving(k, 1, 4)),
        "supersonic beside transonic": (h, moving(h, 1, 4), k, moving(k, 0, 1)),
        "transonic beside supersonic": (h, moving(h, 0, 1), k, moving(k, 1, 4)),
        "fast thin films": shuffled((film, fast(film), other, either(fast(other), moving(other, 0, 1)))),
        "a near -1 and 1": (h, near(h), k, near(k)),
        "near vacuum": (thin, moving(thin, 0, 2), k, moving(k, 0, 2)),
        "dry on one side": (h, moving(h, 0, 2), dry.copy(), dry.copy()),
        "dry on both sides": (dry.copy(), dry.copy(), dry.copy(), dry.copy()),
    }
