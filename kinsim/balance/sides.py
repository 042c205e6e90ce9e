"""Both sides of xi = 0 from the one that holds less of M: the other is the total (3) less it."""

from __future__ import annotations

from ..kernel import kernel


@kernel
def both_sides(h: float, u: float, beta: float, m1: float, m2: float) -> tuple[float, float, float, float]:
    """Moments of xi M and xi^2 M over xi >= 0, then over xi < 0; m1, m2 >= 0 are those of the smaller side, mirrored.

    Mirrored states give bitwise mirrored moments, and both sides add up to the totals.
    """
    total1 = h * u
    total2 = h * u * u + 0.5 * beta * h * h
    if u == 0.0:
        return m1, 0.5 * total2, -m1, 0.5 * total2
    if u > 0.0:
        return total1 + m1, total2 - m2, -m1, m2
    return m1, m2, total1 - m1, total2 - m2
