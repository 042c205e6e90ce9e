"""Theorem 1, (3), (5) and (11): what the equilibrium M carries, symbolically and by quadrature.

Any even chi of mass 1 and second moment beta/2, (5), makes M = sqrt(h) chi((xi - u)/sqrt(h)) carry h, h u and
h u^2 + beta h^2/2, (3). So much for a box and a bell as well. With h and u that vary, the left side of (6) is

    Q = M_t + xi M_x + g M_xi,

and its first two moments are the residuals of (1), whatever h_t, h_x, u_t and u_x are: they vanish, (7), if and only if
(1) holds. That is Theorem 1. It is shown here for symbols, and with numbers on a solution with friction, whose
derivatives are taken by differences; on what is no solution, the moments are the residuals and not 0.

The semicircle (11) alone makes Q itself vanish at rest, (9): a box or a bell is pushed about by a pile that does not
move. Where mass moves, Q does not vanish with the semicircle either; it is what the projection takes away.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import sympy as sp
from claims import Chapter, run
from laboratory.pictures import COLOURS
from matplotlib.figure import Figure
from numpy.typing import NDArray
from scipy.integrate import quad

from kinsim.exact import AcceleratedRiemann, Riemann

Array = NDArray[np.float64]
BETA = 0.4
BOX = np.sqrt(1.5 * BETA)
"""Half-width of a box with second moment beta/2."""

SHAPES: dict[str, tuple[Callable[[float], float], float]] = {
    "semicircle (11)": (lambda w: np.sqrt(max(2 * BETA - w * w, 0.0)) / (np.pi * BETA), np.sqrt(2 * BETA)),
    "box": (lambda w: 0.5 / BOX, BOX),
    "bell": (lambda w: np.exp(-w * w / BETA) / np.sqrt(np.pi * BETA), 8.5 * np.sqrt(0.5 * BETA)),
}
"""chi and the half-width of its support (beyond which the bell is below rounding)."""


def main(chapter: Chapter) -> None:
    """Moments, the theorem for symbols, the theorem with numbers, rest."""
    moments_of_shapes(chapter)
    theorem_for_symbols(chapter)
    theorem_with_numbers(chapter, 2000 if chapter.full else 200)
    chapter.figure(draw(), "collision", "Three densities with the same moments, and what (6) leaves of the semicircle.")


def moments_of_shapes(chapter: Chapter) -> None:
    """(5) and (3) by adaptive quadrature."""
    dice, rows = np.random.default_rng(1), []
    for name, (chi, half) in SHAPES.items():
        five = [quad(lambda w, k=k, chi=chi: w**k * chi(w), -half, half, epsabs=1e-14)[0] for k in range(3)]
        off = np.abs(np.array(five) - [1.0, 0.0, 0.5 * BETA]).max()
        worst = 0.0
        for h, a in zip(10.0 ** dice.uniform(-3, 1, 30), dice.uniform(-3, 3, 30), strict=True):
            s, u = np.sqrt(h), a * np.sqrt(2 * BETA * h)
            three = [quad(lambda xi, k=k, chi=chi, s=s, u=u: xi**k * s * chi((xi - u) / s), u - half * s, u + half * s,
                          epsabs=1e-15)[0] for k in range(3)]  # fmt: skip
            scale = h * (abs(u) + np.sqrt(2 * BETA * h)) ** np.arange(3)
            worst = max(worst, np.abs((np.array(three) - [h, h * u, h * u * u + 0.5 * BETA * h * h]) / scale).max())
        rows.append([name, *five, float(worst)])
        chapter.claim(f"{name}: (5), largest error of the three moments of chi by quadrature", off, high=1e-11)
        chapter.claim(
            f"{name}: (3), largest error of the three moments of M at 30 random (h, u), in flux scales",
            worst,
            high=1e-11,
        )
    chapter.table("Moments of chi, beta = 0.4, which (5) wants to be 1, 0, 0.2; largest error of (3)",
                  ("chi", "mass", "momentum", "second", "(3)"), rows)  # fmt: skip


def theorem_for_symbols(chapter: Chapter) -> None:
    """(5), (10), (11), (7) and (9) with nothing but symbols; xi = u + c sin theta."""
    beta, h, c, C = sp.symbols("beta h c C", positive=True)
    w, xi, u, g, theta = sp.symbols("omega xi u g theta", real=True)
    h_t, h_x, u_t, u_x = sp.symbols("h_t h_x u_t u_x", real=True)

    def whole(of: sp.Expr) -> sp.Expr:
        """The integral over theta from -pi/2 to pi/2, power by power."""
        powers = sp.Poly(of.subs(sp.sin(theta), w), w).terms()
        return sum(a * sp.integrate(sp.sin(theta) ** k, (theta, -sp.pi / 2, sp.pi / 2)) for (k,), a in powers)

    omega = sp.sqrt(2 * beta) * sp.sin(theta)
    square = 2 * beta * (1 - sp.sin(theta) ** 2)  # chi/C d omega/d theta
    constant = sp.solve(C * whole(square) - 1, C)[0]
    chi = C * sp.sqrt(2 * beta - w**2)
    for sentence, off in (
        ("(11): C of mass 1 less 1/(pi beta), symbolically", constant - 1 / (sp.pi * beta)),
        ("(5): second moment less beta/2, symbolically", whole(constant * omega**2 * square) - beta / 2),
        ("(10): its left side with (11), symbolically", w * chi + (2 * beta - w**2) * sp.diff(chi, w)),
    ):
        chapter.claim(sentence, _nil(off), low=0, high=0)

    # xi = u + c sin theta: d xi/d theta = c cos theta, the root in M, takes the singular rims of its derivatives away
    root = sp.sqrt(2 * beta * h - (xi - u) ** 2)
    M = root / (sp.pi * beta)
    M_h, M_u, M_xi = (sp.simplify(sp.diff(M, by) * root) for by in (h, u, xi))
    Q = (M_h * h_t + M_u * u_t) + xi * (M_h * h_x + M_u * u_x) + g * M_xi
    zeroth, first = (whole(sp.expand((xi**k * Q).subs(xi, u + c * sp.sin(theta)))) for k in (0, 1))
    mass = h_t + u * h_x + h * u_x
    momentum = (u * h_t + h * u_t) + (u**2 * h_x + 2 * h * u * u_x + beta * h * h_x) - g * h
    width = {c: sp.sqrt(2 * beta * h)}
    for sentence, off in (
        ("Theorem 1: int Q less the residual of (1), mass, symbolically", zeroth.subs(width) - mass),
        ("Theorem 1: int xi Q less the residual of (1), momentum, symbolically", first.subs(width) - momentum),
        ("(9): Q at rest with g = beta h_x, symbolically", Q.subs({h_t: 0, u_t: 0, u_x: 0, u: 0, g: beta * h_x})),
    ):
        chapter.claim(sentence, _nil(off), low=0, high=0)
    for name, other in (("bell", sp.exp(-(w**2) / beta)), ("box", sp.Integer(1))):
        left = w * other + (2 * beta - w**2) * sp.diff(other, w)
        size = sp.lambdify(w, sp.Abs(left.subs(beta, sp.Rational(2, 5))))(np.linspace(-0.75, 0.75, 301)).mean()
        chapter.claim(f"{name}: mean size of the left side of (10) for |omega| < 3/4: no rest", size, low=0.05)


def _nil(difference: sp.Expr) -> float:
    """0 if the difference simplifies to 0, else NaN."""
    return 0.0 if sp.simplify(sp.expand(difference)) == 0 else float("nan")


def theorem_with_numbers(chapter: Chapter, count: int) -> None:
    """Moments of Q by quadrature in the fan of an avalanche with friction, and off any solution."""
    dice = np.random.default_rng(2)
    worst, apart, size = 0.0, 0.0, 1e300
    for x, bent in zip(dice.uniform(-0.05, 0.17, count), dice.uniform(-1, 1, (count, 4)), strict=True):
        h, u, ht, ut, hx, ux = derivatives(x, 1.0)
        worst = max(worst, *np.abs(moments_of_Q(h, u, ht, ut, hx, ux)))
        ht, ut, hx, ux = np.array([ht, ut, hx, ux]) + bent  # no solution any more
        residuals = ht + u * hx + h * ux, u * ht + h * ut + (u * u + BETA * h) * hx + 2 * h * u * ux - PULL * h
        apart = max(apart, *np.abs(moments_of_Q(h, u, ht, ut, hx, ux) - residuals))
        size = min(size, float(np.abs(residuals).max()))
    chapter.claim(f"(7): largest moment of Q on a solution with friction, {count} places, differences of step 1e-3",
                  worst, high=1e-9)  # fmt: skip
    chapter.claim("(7) with other slopes, which solve nothing: moments of Q less residuals of (1)", apart, high=1e-12)
    chapter.claim("(7) with other slopes: least residual of (1) among them", size, low=1e-3)


FLOW = AcceleratedRiemann(Riemann(1.0, 0.5, 0.5, 0.5, BETA), 0.3, 0.2)
"""A fan that slides: sin zeta = 0.3 pulls, R = 0.2 holds."""
PULL = 0.1


def derivatives(x: float, t: float) -> tuple[float, ...]:
    """h, u, h_t, u_t, h_x, u_x by central differences of fourth order."""
    e = 1e-3
    steps, weights = np.array([-2, -1, 1, 2]) * e, np.array([1, -8, 8, -1]) / (12 * e)
    in_t = np.array([[part[0] for part in FLOW(np.array([x]), t + s)] for s in steps])
    in_x = np.array(FLOW(x + steps, t))
    h, u = (float(part[0]) for part in FLOW(np.array([x]), t))
    return h, u, *map(float, weights @ in_t), *map(float, in_x @ weights)


def collision(theta: Array, h: float, u: float, ht: float, ut: float, hx: float, ux: float, g: float) -> Array:
    """Q d xi/d theta at xi = u + c sin theta."""
    c = np.sqrt(2 * BETA * h)
    xi = u + c * np.sin(theta)
    return ((ht + xi * hx) + (ut + xi * ux - g) * c * np.sin(theta) / BETA) / np.pi


def moments_of_Q(h: float, u: float, ht: float, ut: float, hx: float, ux: float) -> Array:
    """int Q and int xi Q by Gauss-Legendre in theta."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    theta = 0.5 * np.pi * nodes
    xi = u + np.sqrt(2 * BETA * h) * np.sin(theta)
    return np.array([xi**k * collision(theta, h, u, ht, ut, hx, ux, PULL) @ (0.5 * np.pi * weights) for k in (0, 1)])


def draw() -> Figure:
    """Left the three shapes, right Q over xi."""
    figure = Figure(figsize=(11, 4.4), layout="constrained")
    left, right = figure.subplots(1, 2)
    w = np.linspace(-1.5, 1.5, 1501)
    for number, (name, (chi, half)) in enumerate(SHAPES.items()):
        left.plot(w, [chi(v) if abs(v) <= half else 0.0 for v in w], color=COLOURS[number], label=name,
                  linestyle=("-", "--", "-.")[number], linewidth=1.8)  # fmt: skip
    left.set_title("three chi with the moments (5), beta = 0.4", loc="left", fontsize=10)
    left.set(xlabel=r"$\omega$ (dimensionless)", ylabel=r"$\chi(\omega)$", ylim=(0, 1.02))
    left.legend(frameon=False, loc="upper right")
    h, u, ht, ut, hx, ux = derivatives(0.1, 1.0)
    theta = np.linspace(-0.48, 0.48, 800) * np.pi
    c = np.sqrt(2 * BETA * h)
    rigid = collision(theta, h, u, ht, ut, hx, ux, PULL) / (c * np.cos(theta))
    rest = collision(theta, h, 0.0, 0.0, 0.0, hx, 0.0, BETA * hx) / (c * np.cos(theta))
    right.plot(c * np.sin(theta), rigid, color=COLOURS[0], linewidth=1.8, label="in a fan that slides")
    right.plot(c * np.sin(theta), rest, color=COLOURS[1], linewidth=1.8, linestyle="--", label="on a slope at rest: 0")
    right.set_title("Q of (6) with the semicircle: two moments vanish, Q does not", loc="left", fontsize=10)
    right.set(xlabel=r"$\xi - u$ (dimensionless)", ylabel=r"$Q$", ylim=(-0.32, 0.32))
    right.legend(frameon=False, loc="upper center")
    for axes in (left, right):
        axes.grid(alpha=0.25)
        axes.spines[["top", "right"]].set_visible(False)
    return figure


if __name__ == "__main__":
    run(main, __doc__)
