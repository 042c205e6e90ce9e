"""Every misprint of the paper, by number: wrong as printed, right as corrected.

Formulas are judged by quadrature of the integral that they stand for, the fan velocity by its Riemann invariant and by
the exact solution, statements about (1) by what they say. Errors of fluxes are in flux scales h (|u| + c)^k, the
largest over random states of the branch in question. With the printed I3 the flux is not even consistent: at h = 1,
u = 0.3, beta = 0.4 it gives 0.110 for what should be h u^2 + beta h^2/2 = 0.290.

Of the others there is no number: a missing 1 in a condition, a year, two names for one sign.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import sympy as sp
from claims import Chapter, run
from laboratory.pictures import COLOURS
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.integrate import quad
from scipy.linalg import expm

from kinsim import crosscheck, printed
from kinsim.exact import Riemann
from kinsim.schemes.formulas import acceleration

Array = NDArray[np.float64]
BETA = 0.4
RIGHT = 1e-12
"""Below this a formula is right; the closed forms themselves lose a few digits of 1e-16 near a = 1."""


def moment(h: float, u: float, k: int, side: int) -> float:
    """int xi^k M over xi > 0 or xi < 0, adaptive quadrature in theta, xi = u + c sin theta."""
    c = np.sqrt(2 * BETA * h)
    switch = float(np.arcsin(np.clip(-u / c, -1, 1)))
    ends = (switch, 0.5 * np.pi) if side > 0 else (-0.5 * np.pi, switch)
    value = quad(lambda t: (u + c * np.sin(t)) ** k * np.cos(t) ** 2, *ends, epsabs=1e-15, epsrel=1e-13)[0]
    return 2.0 * h / np.pi * value


def error(formula: Callable[[float, float], float], k: int, side: int, count: int, a: tuple[float, float]) -> float:
    """Largest error of a half-range moment at random states with -u/c in `a`, in flux scales."""
    dice = np.random.default_rng(7)
    worst = 0.0
    for h, ratio in zip(10.0 ** dice.uniform(-2, 1, count), dice.uniform(*a, count), strict=True):
        c = np.sqrt(2 * BETA * h)
        u = -ratio * c
        worst = max(worst, abs(formula(h, u) - moment(h, u, k, side)) / (h * (abs(u) + c) ** k))
    return worst


def main(chapter: Chapter) -> None:
    """The list, the same by crosscheck, the right ones, the picture."""
    count = 2000 if chapter.full else 100
    rows = misprints(count)
    for number, what, as_printed, corrected, _ in rows:
        if as_printed is not None:
            chapter.claim(f"{number}. {what}: error as printed", as_printed, low=1e-3)
        if corrected is not None:
            chapter.claim(f"{number}. {what}: error as corrected", corrected, high=RIGHT)
    shown = [[n, what, *("-" if v is None else v for v in (a, b)), note] for n, what, a, b, note in rows]
    chapter.table("Misprints", ("", "where", "error as printed", "as corrected", "how it was judged"), shown)
    whole_flux(chapter)
    for name, k, side in (("I1", 1, 1), ("I2", 1, -1), ("I3_tilde", 2, 1), ("I4_tilde", 2, -1)):
        formula = getattr(printed, name)
        found = error(lambda h, u, f=formula: f(h, u, BETA), k, side, count, (-1.5, 1.5))
        chapter.claim(f"right as printed: {name}, all branches", found, high=RIGHT)
    chapter.figure(draw(rows), "list", "Errors as printed and as corrected, by number of the misprint.")


def misprints(count: int) -> list[tuple[int, str, float | None, float | None, str]]:
    """Number, place, error as printed, error as corrected, how it was judged."""
    middle, beyond, flux_scale = (-0.95, 0.95), (1.05, 3.0), "half-range moment by quadrature, in flux scales"
    p = printed

    def I3(**mended: bool) -> float:
        return error(lambda h, u: p.I3(h, u, BETA, **mended), 2, 1, count, middle)

    def tilde(f: Callable[..., float], side: int, mended: bool) -> float:
        return error(lambda h, u: f(h, u, BETA, bracket_mended=mended), 1, side, count, middle)

    def I4(left: float | None) -> float:
        other = None if left is None else left
        return error(lambda h, u: p.I4(h, u, BETA, u_left=other), 2, -1, count, beyond)

    right = I3(sine_mended=True, sign_mended=True)
    return [
        (1, "I3, sin(a1) for sin(4 arcsin a1)", I3(sign_mended=True), right, flux_scale),
        (2, "I3, minus before cos^3", I3(sine_mended=True), right, flux_scale),
        (3, "I4 beyond the support, u_i for u_{i+1}", I4(0.0), I4(None), flux_scale + ", left cell at rest"),
        (4, "I~1, a term outside its bracket", tilde(p.I1_tilde, 1, False), tilde(p.I1_tilde, 1, True), flux_scale),
        (5, "I~2, a term outside its bracket", tilde(p.I2_tilde, -1, False), tilde(p.I2_tilde, -1, True), flux_scale),
        (6, "I~4, condition a~2 >= .", None, error(lambda h, u: p.I4_tilde(h, u, BETA), 2, -1, count, beyond),
         "no number to read; with 1 the branch is right"),
        (7, "F~ as integrals of M, not of M~", *faces(count), "sums of the I~ against both integrals"),
        (8, "velocity in the fan, -u_l/2", fan(False), fan(True), "u + 2 sqrt(beta h), constant in a fan"),
        (9, "g(q) for g(u)", None, sign_of_g(), "no error: q and u have one sign"),
        (10, "hyperbolic for h >= 0", *hyperbolic(count), "how waves grow with wave number, as an order"),
        (11, "reference [10], 1998", None, None, "a year: J. Fluid Mech. 199 is 1989"),
        (12, "(8) where the slope varies", *varying_slope(), "residual of (13) at rest over g h; not in print as such"),
    ]  # fmt: skip


def faces(count: int) -> tuple[float, float]:
    """The mended sums I~1 + I~2, I~3 + I~4 at mean heights against integrals of the upwind and the balanced states."""
    dice, off = np.random.default_rng(8), np.zeros(2)
    for h_left, h_right, a, b in zip(*10.0 ** dice.uniform(-1, 0.5, (2, count)), *dice.uniform(-0.9, 0.9, (2, count)),
                                     strict=True):  # fmt: skip
        mean = 0.5 * (h_left + h_right)
        c = np.sqrt(2 * BETA * mean)
        u, v = -a * c, -b * c
        first = (f(mean, w, BETA, bracket_mended=True) for f, w in ((printed.I1_tilde, u), (printed.I2_tilde, v)))
        mine = sum(first), printed.I3_tilde(mean, u, BETA) + printed.I4_tilde(mean, v, BETA)
        for k, found in enumerate(mine, start=1):
            for which, (left, right) in enumerate(((h_left, h_right), (mean, mean))):
                integral = moment(left, u, k, 1) + moment(right, v, k, -1)
                off[which] = max(off[which], abs(found - integral) / (2 * mean * (2 * c) ** k))
    return float(off[0]), float(off[1])


def fan(mended: bool) -> float:
    """Departure of u + 2 sqrt(beta h) from its value on the left, and of u from the exact solution, u_l = 0.6."""
    exact = Riemann(1.0, 0.6, 0.2, 0.6, BETA)
    begin, end, *_ = exact.speeds
    rays = np.linspace(begin, end, 102)[1:-1]
    u = np.array([printed.fan_velocity(ray, 1.0, 0.6, BETA, sign_mended=mended) for ray in rays])
    h = np.array([printed.fan_height(ray, 1.0, 0.6, BETA) for ray in rays])
    invariant = u + 2 * np.sqrt(BETA * h) - (0.6 + 2 * np.sqrt(BETA))
    return float(max(np.abs(invariant).max(), np.abs(u - exact(rays, 1.0)[1]).max()))


def sign_of_g() -> float:
    """Largest |g(q) - g(u)| over h > 0."""
    dice = np.random.default_rng(9)
    h, u = 10.0 ** dice.uniform(-12, 1, 10_000), dice.normal(size=10_000)
    s, R = 0.2, 0.3
    return max(abs(acceleration(q, s, R) - (s - np.sign(v) * R)) for q, v in zip(h * u, u, strict=True))


def hyperbolic(count: int) -> tuple[float, float]:
    """Order in the wave number at which waves are amplified, at h = 0, which the print includes, and for h > 0.

    Linearised, a wave of number k grows by exp(-i k A t), A the Jacobian of (1) with eigenvalues u -+ a. With two
    eigenvectors it is bounded for all k; its norm is largest where k a t is an odd multiple of pi/2, and the same there
    for every k. At h = 0 one eigenvector is missing, the norm grows like k, and (1) is ill posed: order 1 for order 0.
    """
    dice = np.random.default_rng(10)
    dry = min(growth(0.0, float(u)) for u in dice.uniform(-1, 1, count))
    wet = max(abs(growth(float(h), float(u))) for h, u in zip(10.0 ** dice.uniform(-2, 1, count),
              dice.uniform(-1, 1, count), strict=True))  # fmt: skip
    return dry, wet


def growth(h: float, u: float) -> float:
    """Slope of log |exp(-i k A)| over log k."""
    jacobian = np.array([[0.0, 1.0], [BETA * h - u * u, 2.0 * u]])
    k = 0.5 * np.pi / np.sqrt(BETA * h) * np.array([1, 5, 21]) if h > 0.0 else np.array([16.0, 64.0, 256.0])
    norms = [np.linalg.norm(expm(-1j * each * jacobian), 2) for each in k]
    return float(np.polyfit(np.log(k), np.log(norms), 1)[0])


def varying_slope() -> tuple[float, float]:
    """(beta h^2/2)_x - g h with beta h_x = g, and with beta h_x + beta' h/2 = g, over g h, at x = 0.3."""
    x, g = sp.symbols("x g", positive=True)
    beta, h = BETA * sp.cos(sp.Rational(1, 5) + x), sp.Function("h")(x)
    left: Any = sp.diff(beta * h**2 / 2, x) - g * h
    numbers = {x: 0.3, g: 0.2}
    found = []
    for slope in (g / beta, (g - sp.diff(beta, x) * h / 2) / beta):
        residual = left.subs(sp.Derivative(h, x), slope) / (g * h)
        found.append(abs(float(residual.subs(h, 1.0).subs(numbers))))
    return found[0], found[1]


def whole_flux(chapter: Chapter) -> None:
    """The printed and the corrected flux before `kinsim.crosscheck`."""
    as_printed = crosscheck(printed.flux, beta=BETA)
    corrected = crosscheck(mended, beta=BETA)
    chapter.claim("crosscheck: regimes in which the printed flux fails", sum(not r.passes for r in as_printed.regimes),
                  low=1)  # fmt: skip
    chapter.claim("crosscheck: regimes in which the corrected flux fails", sum(not r.passes for r in corrected.regimes),
                  low=0, high=0)  # fmt: skip
    for one, expected in (("printed", (0.105, 0.115)), ("corrected", (0.29 - 1e-12, 0.29 + 1e-12))):
        _, second = (printed.flux if one == "printed" else mended)(*(np.array([v]) for v in (1, 0.3, 1, 0.3)), 0.4)
        chapter.claim(f"{one} flux: (F(U, U))^2 at h = 1, u = 0.3, where h u^2 + beta h^2/2 = 0.29", float(second[0]),
                      low=expected[0], high=expected[1])  # fmt: skip
    rows = [[r.name, r.quadrature, r.consistency, s.quadrature, s.consistency]
            for r, s in zip(as_printed.regimes, corrected.regimes, strict=True)]  # fmt: skip
    chapter.table(f"crosscheck, errors in flux scales; the printed flux first fails: {as_printed.first_failure}",
                  ("regime", "printed", "F(U, U)", "corrected", "F(U, U)"), rows)  # fmt: skip


def mended(h_left: Array, u_left: Array, h_right: Array, u_right: Array, beta: float) -> tuple[Array, Array]:
    """The flux of (24) with misprints 1 to 3 mended."""
    first, second = np.zeros(h_left.shape), np.zeros(h_left.shape)
    for i, (hl, ul, hr, ur) in enumerate(zip(h_left, u_left, h_right, u_right, strict=True)):
        if hl > 0:
            first[i] += printed.I1(hl, ul, beta)
            second[i] += printed.I3(hl, ul, beta, sine_mended=True, sign_mended=True)
        if hr > 0:
            first[i] += printed.I2(hr, ur, beta)
            second[i] += printed.I4(hr, ur, beta)
    return first, second


def draw(rows: list[tuple[int, str, float | None, float | None, str]]) -> Figure:
    """One line per misprint with a number."""
    kept = [row for row in rows if row[2] is not None]
    figure = Figure(figsize=(10, 0.42 * len(kept) + 1.5), layout="constrained")
    axes = figure.subplots()
    places = -np.arange(len(kept))
    for number, (label, column) in enumerate((("as corrected", 3), ("as printed", 2))):
        values = [max(row[column] if row[column] is not None else 0.0, 1e-17) for row in kept]
        axes.semilogx(values, places, "os"[number], color=COLOURS[number], markersize=8, label=label)
    for place, row in zip(places, kept, strict=True):
        axes.plot([max(row[3] or 0.0, 1e-17), row[2]], [place, place], color="0.8", zorder=0)
    axes.axvline(RIGHT, color="0.6", linewidth=1, linestyle="--")
    axes.annotate(
        "right", (RIGHT, 0.55), xytext=(-4, 0), textcoords="offset points", ha="right", fontsize=9, color="0.4"
    )
    axes.set_yticks(places, [f"{row[0]}. {row[1]}" for row in kept])
    axes.set(xlabel="error (dimensionless; 1e-17 stands for 0)", ylim=(places[-1] - 0.6, 0.9), xlim=(3e-18, 1e3))
    axes.legend(frameon=False, loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2)
    axes.spines[["top", "right"]].set_visible(False)
    return figure


if __name__ == "__main__":
    run(main, __doc__)
