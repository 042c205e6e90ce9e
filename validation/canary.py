"""Five promises that break first when something is wrong.

Each is cheap and sharp: the closed-form flux is the integral of M, the shift hands the impulse over with the right
sign, nothing passes a wall, one flux per face keeps the mass, and the cells that schemes 2 and 3 call slow are those
that friction would stop. The test suite breaks each of them on purpose (the printed I3, a reversed shift, a ghost cell
left empty, a coupling by cell sold as conservative, half the threshold of slow cells) and sees this chapter turn red.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from claims import Chapter, run
from laboratory.slow import slow_cells

from kinsim import (
    Cells,
    ConstantSlope,
    Coulomb,
    Fixed,
    Kinetic,
    Macroscopic,
    Profile,
    Scene,
    Uniform,
    crosscheck,
    load_scene,
    simulate,
    step,
)
from kinsim.arrays import Array
from kinsim.exact import random_pile
from kinsim.macroscopic import closed_form


def main(chapter: Chapter) -> None:
    """One number for each promise."""
    found = crosscheck(closed_flux, count=400 if chapter.full else 100)
    worst = max(max(regime.quadrature, regime.consistency, regime.mirror) for regime in found.regimes)
    chapter.claim(
        "closed-form flux against quadrature, consistency, symmetry: worst regime, flux scales", worst, high=1e-13
    )
    rows = [
        [r.name, f"{r.quadrature:.1e}", f"{r.grid:.1e}", f"{r.consistency:.1e}", f"{r.mirror:.1e}"]
        for r in found.regimes
    ]
    chapter.table(
        "the closed-form flux, regime by regime", ["regime", "quadrature", "grid", "consistency", "mirror"], rows
    )

    scene, _, _ = load_scene("sine")
    h, q = scene.initial()
    now = step(scene, Kinetic(1, Uniform(64), "matched"), h, q + 0.1 * h, 1e-2)
    momentum = (now.xi[1] - now.xi[0]) * (now.f_force @ now.xi)
    chapter.claim(
        "momentum of f after the shift less q, over the impulse",
        np.abs(momentum - now.q1).max() / np.abs(now.impulse).max(), high=1e-12,
    )  # fmt: skip

    cells = Cells(-2, 2, 40)
    heap = random_pile(cells, pull=0.0, resistance=0.3, beta=0.4, fill=4.0, per="face", rng=3)
    walled = replace(
        scene, cells=cells, heap=heap, friction=Coulomb(0.3), chute=replace(scene.chute, zeta=0.0), boundary="wall"
    )
    for method in (Macroscopic(1), Kinetic(1, Uniform(64))):
        mass = simulate(walled, method, Fixed(5e-3, 200), 200).entries["mass"]
        drift = abs(mass[-1] / mass[0] - 1)
        chapter.claim(f"mass between walls, {method.kind}, relative change", drift, high=1e-13)

    silo, _, _ = load_scene("silo")
    one = simulate(silo, Macroscopic(3, "face"), Fixed(1e-3, 500), 500)
    chapter.claim("mass with one flux per face, silo, relative drift", abs(one.mass_drift), high=1e-13)
    slow(chapter, walled)


def slow(chapter: Chapter, scene: Scene) -> None:
    """Random momenta up to twice what friction can stop, some of them 0, on three slopes."""
    count, dt, dice = 2000, 1e-2, np.random.default_rng(5)
    cells, unlike, shares = Cells(0, 0.05 * count, count), 0, []
    for zeta in (0.0, 0.1, -0.5):
        ground = replace(scene, cells=cells, chute=ConstantSlope(zeta), boundary="open", heap=Profile(np.ones(count)))
        h, sign = dice.uniform(0.2, 2.0, count), dice.choice([-1.0, 0.0, 1.0], count, p=[0.45, 0.1, 0.45])
        stopped = np.abs(ground.chute.sin - sign * ground.resistance)
        q = sign * dice.uniform(0.0, 2.0, count) * dt * stopped * h
        found = step(ground, Macroscopic(3), h, q, dt).slow[1:-1]
        unlike += int((found != slow_cells(ground, h, q, dt)).sum())
        shares.append(float(found.mean()))
    chapter.claim("slow cells of scheme 3: those that an independent derivation judges otherwise, of 6000", unlike,
                  low=0, high=0)  # fmt: skip
    chapter.claim("slow cells of scheme 3: their least share, of momenta up to twice the threshold", min(shares),
                  low=0.4, high=0.7)  # fmt: skip


def closed_flux(h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: float) -> tuple[Array, Array]:
    """The flux that the macroscopic wing takes."""
    left, right, betas = np.empty((4, h_left.size)), np.empty((4, h_left.size)), np.full(h_left.size, beta)
    closed_form.half_moments_of_cells(closed_form.ClosedForm(), h_left, u_left, betas, left)
    closed_form.half_moments_of_cells(closed_form.ClosedForm(), h_right, u_right, betas, right)
    return left[0] + right[2], left[1] + right[3]


if __name__ == "__main__":
    run(main, __doc__)
