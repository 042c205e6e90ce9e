"""Where schemes 2 and 3 do not converge, and why: two linear instabilities below the CFL bound.

Both schemes keep rest by the balanced flux F~, which diffuses u but not h. What that costs shows in the growth of
small waves on a uniform layer, per step and wave number, and then on exact solutions.

- On a moving layer scheme 2, which takes F~ in every cell, amplifies waves of some seven cells at Courant numbers of
  0.8 and 0.9 by up to four percent per step; at 0.6 and below it does not, up to u = 1.2 for h = 1. Finer cells make
  more steps, so that finer cells do not help: on the travelling shock and on fan and shock the errors at Courant 0.9
  are many times those of scheme 1. Scheme 3 takes F in moving cells, and scheme 1 everywhere: both damp all waves.
- At rest a slow cell gives all of q to friction, and what F~ diffuses into it comes back with the factor 16/(3 pi)
  dt/dx c at the odd-even mode, c = sqrt(2 beta h). Beyond a Courant number of 3 pi/16 = 0.589 that is more than 1,
  under schemes 2 and 3 alike: a pile that the exact solution keeps wakes from its own rounding, the sooner the finer
  its cells, until cells are slow no longer.
"""

from __future__ import annotations

import math
from itertools import product

import numpy as np
from claims import Chapter, run
from laboratory.judged import BETA, CASES, HELD, UNSTABLE
from laboratory.orders import halvings
from laboratory.pictures import COLOURS, MARKS
from matplotlib.figure import Figure
from numpy.typing import NDArray

from kinsim import (
    Cells,
    ConstantSlope,
    Coulomb,
    Courant,
    Fixed,
    Frictionless,
    Macroscopic,
    Profile,
    Scene,
    step,
    study,
)

Array = NDArray[np.float64]
COURANT = (0.3, 0.6, 0.8, 0.9)
SPEEDS = (0.0, 0.6, 1.2)
COUNT = 48


def main(chapter: Chapter) -> None:
    """Waves on a moving layer, what they do to shocks, the odd-even mode of rest, what it does to a pile."""
    found = {key: waves(*key) for key in product((1, 2), SPEEDS, COURANT)}
    largest = {key: float(factors.max()) for key, factors in found.items()}
    rows = [[scheme, u, *(f"{largest[scheme, u, c]:.4f}" for c in COURANT)] for scheme, u in product((1, 2), SPEEDS)]
    heads = ("scheme", "u", *(f"Courant {c}" for c in COURANT))
    chapter.table("Largest factor per step of a wave on a layer h = 1 without friction", heads, rows)
    chapter.claim("scheme 1: largest factor, all layers", max(x for k, x in largest.items() if k[0] == 1), high=1.0)
    for courant, low, high in ((0.3, -1e-9, 1e-9), (0.6, -1e-9, 1e-3), (0.9, 0.03, 0.05)):
        chapter.claim(f"scheme 2, u = 1.2, Courant {courant}: largest factor, less 1", largest[2, 1.2, courant] - 1,
                      low=low, high=high)  # fmt: skip
    shocks(chapter, halvings(140, 5 if chapter.full else 3))
    mode(chapter)
    woken = pile(chapter)
    chapter.figure(draw(found, woken), "waves", "Left and middle: factor per step of waves on a layer with u = 1.2. "
                   "Right: a pile at rest, scheme 3, by its Courant number.")  # fmt: skip


def waves(scheme: int, u: float, courant: float) -> Array:
    """Largest factor per step of waves in h and q on a layer, by wave number 1, ..., COUNT/2."""
    dx, tiny = 0.05, 1e-6
    layer = Scene(Cells(0, COUNT * dx, COUNT), Profile(np.ones(COUNT)), friction=Frictionless(), boundary="periodic",
                  epsilon=BETA)  # fmt: skip
    dt = courant * dx / (u + math.sqrt(2 * BETA))
    pulse = tiny * (np.arange(COUNT) == 0)
    answers = []
    for dh, dq in ((pulse, 0 * pulse), (0 * pulse, pulse)):
        there, back = (step(layer, Macroscopic(scheme), 1 + s * dh, u + s * dq, dt) for s in (1, -1))
        answers.append([np.fft.rfft(there.h1 - back.h1), np.fft.rfft(there.q1 - back.q1)])
    matrices = np.array(answers).transpose(2, 1, 0) / (2 * tiny)
    return np.abs(np.linalg.eigvals(matrices)).max(axis=1)[1:]


def shocks(chapter: Chapter, counts: list[int]) -> None:
    """Scheme 2 against scheme 1 at Courant 0.9, judged by exact solutions."""
    rows = []
    for name in ("shock", "fan and shock"):
        case = CASES[name]
        errors = [case.errors(Macroscopic(scheme), Courant(0.9, case.end), counts) for scheme in (1, 2)]
        rows += [[name, scheme, *each] for scheme, each in zip((1, 2), errors, strict=True)]
        chapter.claim(f"{name}, Courant 0.9: L1(h) of scheme 2 over that of scheme 1, finest cells",
                      errors[1][-1] / errors[0][-1], low=8.0)  # fmt: skip
    chapter.table("L1(h) at Courant 0.9", ("exact solution", "scheme", *(f"dx = {14 / n:g}" for n in counts)), rows)


def mode(chapter: Chapter) -> None:
    """One step of the odd-even mode of q on a level layer that friction holds."""
    dx, tiny = 0.05, 1e-9
    zigzag = tiny * (-1.0) ** np.arange(COUNT)
    zeta = math.asin(HELD["pull"])
    held = Scene(Cells(0, COUNT * dx, COUNT), Profile(np.ones(COUNT)), ConstantSlope(zeta),
                 Coulomb(math.atan(HELD["resistance"] / math.cos(zeta))), epsilon=BETA / math.cos(zeta),
                 boundary="periodic")  # fmt: skip
    for scheme, courant in product((2, 3), (0.3, 0.9)):
        dt = courant * dx / math.sqrt(2 * BETA)
        now = step(held, Macroscopic(scheme), np.ones(COUNT), zigzag, dt)
        factor = float(-(now.q1 / zigzag).mean())
        chapter.claim(f"scheme {scheme}, rest, Courant {courant}: factor of the odd-even mode, less 16/(3 pi) dt/dx c",
                      abs(factor - courant / UNSTABLE), high=1e-6)  # fmt: skip


def pile(chapter: Chapter) -> dict[float, Array]:
    """A pile at rest from rounding; its Courant number is that of its top, so that it bounds the growth."""
    case, woken, rows = CASES["pile"], {}, []
    scene = case.scene(140)
    c = math.sqrt(2 * scene.beta * float(scene.initial()[0].max()))
    schemes, numbers = (2, 3), (0.3, 0.55, 0.75, 0.9)
    over = {"method.scheme": schemes, "clock.dt": [courant * scene.cells.dx / c for courant in numbers]}
    runs = study(scene, Macroscopic(2), Fixed(1.0, 300), over, fields=["q"], save_every=1)
    for (at, scheme), (k, courant) in product(enumerate(schemes), enumerate(numbers)):
        sizes = np.abs(runs["history_q"].to_numpy()[at, k]).max(axis=1)
        growing = sizes[(sizes > 1e-13) & (sizes < 1e-6)]
        rate = math.exp(np.polyfit(np.arange(growing.size), np.log(growing), 1)[0]) if growing.size > 9 else 1.0
        rows.append([scheme, courant, courant / UNSTABLE, rate, float(sizes[-1])])
        what = f"pile, scheme {scheme}, Courant {courant} at its top"
        if courant < UNSTABLE:
            chapter.claim(f"{what}: largest |q| in 300 steps", sizes.max(), high=1e-13)
        else:
            chapter.claim(f"{what}: growth of |q| per step", rate, low=1.05, high=courant / UNSTABLE)
        if scheme == 3:
            woken[courant] = sizes
    chapter.table("Pile at rest, 300 steps from rounding", ("scheme", "Courant number", "over 3 pi/16",
                  "growth of |q| per step", "largest |q| at the end"), rows)  # fmt: skip
    for scheme in (2, 3):
        ends = case.errors(Macroscopic(scheme), Courant(0.9, 8.0), (140, 280, 560))
        chapter.claim(f"pile, scheme {scheme}, Courant 0.9, t = 8: L1(h) at dx = 0.025 over that at 0.1",
                      ends[-1] / ends[0], low=1.0)  # fmt: skip
        chapter.claim(f"pile, scheme {scheme}, Courant 0.9, t = 8: L1(h) at dx = 0.025", ends[-1], low=1e-2)
    return woken


def draw(found: dict[tuple[int, float, float], Array], woken: dict[float, Array]) -> Figure:
    """Factors by wave number for both schemes, and the pile over steps."""
    figure = Figure(figsize=(14, 4.2), layout="constrained")
    panels = figure.subplots(1, 3)
    wave = 2 * np.arange(1, COUNT // 2 + 1) / COUNT
    for axes, scheme in zip(panels[:2], (1, 2), strict=True):
        for number, courant in enumerate(COURANT):
            axes.plot(wave, found[scheme, 1.2, courant], color=COLOURS[number], marker=MARKS[number], markersize=4,
                      linewidth=1.4, label=f"Courant {courant}")  # fmt: skip
        axes.axhline(1, color="0.6", linewidth=1)
        axes.set_title(f"scheme {scheme}: factor per step, u = 1.2", loc="left", fontsize=10)
        axes.set(xlabel="wave number over pi/dx (1: odd-even)", ylim=(0.6, 1.08))
        axes.legend(frameon=False, loc="lower left", ncols=2)
    for number, (courant, sizes) in enumerate(woken.items()):
        panels[2].semilogy(np.maximum(sizes, 1e-18), color=COLOURS[number], linewidth=1.6, label=f"Courant {courant}",
                           linestyle=("-", "--", "-.", ":")[number])  # fmt: skip
    panels[2].set_title("scheme 3: largest |q| of a pile at rest", loc="left", fontsize=10)
    panels[2].set(xlabel="step", ylim=(1e-18, 1e3))
    panels[2].legend(frameon=False, loc="upper left", ncols=2)
    for axes in panels:
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


if __name__ == "__main__":
    run(main, __doc__)
