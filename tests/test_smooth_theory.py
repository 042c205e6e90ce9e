"""Section 2.2 derived anew: Theorem 2 and its relatives with symbols, the maps of the forces by ODEs and quadrature."""

from __future__ import annotations

import numpy as np
import pytest
import sympy as sp
from scipy.integrate import quad, solve_ivp

from kinsim.errors import InputError
from kinsim.smooth.affine import affine_map
from kinsim.smooth.equilibrium import chi, equilibrium
from kinsim.smooth.forces import affine, quadratic, residual_of_17, residual_of_family
from kinsim.smooth.riccati import STEEPEST, Riccati, refuse_steep, riccati

t, x, xi, w, c, g = sp.symbols("t x xi w c g", real=True)
rho, u, beta = (sp.Function(name)(t, x) for name in ("rho", "u", "beta"))
beta = sp.Function("beta", positive=True)(x)
gamma = beta.diff(x) / beta
HALF = sp.Rational(1, 2)

CHI = sp.sqrt(2 - w**2) / sp.pi
CHI_MOMENTS = [sp.integrate((sp.sqrt(2) * sp.sin(x)) ** k * 2 * sp.cos(x) ** 2 / sp.pi, (x, -sp.pi / 2, sp.pi / 2))
               for k in range(5)]  # fmt: skip


def moment(polynomial: sp.Expr) -> sp.Expr:
    """int p(xi) M(rho, xi - u) dxi for a polynomial p: term by term after xi = u + sqrt(rho) w, odd powers being 0."""
    s = sp.Symbol("s", positive=True)
    found = sp.Poly(sp.expand(polynomial.subs(xi, u + s * w)), w)
    terms = sum(a * rho * CHI_MOMENTS[k] for (k,), a in found.terms())
    return sp.expand(sp.expand(terms).subs(s**2, rho).subs(s**4, rho**2))


def test_semicircle_meets_16() -> None:
    assert CHI_MOMENTS[:3] == [1, 0, HALF]
    root = np.sqrt(2)
    for k, expected in enumerate(CHI_MOMENTS):
        found = quad(lambda a, k=k: chi(root * np.sin(a)) * (root * np.sin(a)) ** k * root * np.cos(a),
                     -np.pi / 2, np.pi / 2, epsabs=1e-14)[0]  # fmt: skip
        assert found == pytest.approx(float(expected), abs=1e-13)
    assert chi(1.5) == 0.0
    assert equilibrium(1.3, 0.5, 0.7) == pytest.approx(np.sqrt(0.5) * chi(0.6 / np.sqrt(0.5)), rel=1e-15)


def residuals_of_14() -> tuple[sp.Expr, sp.Expr]:
    m = rho * u
    second = m**2 / rho + rho**2 / 2
    mass = rho.diff(t) + m.diff(x) - gamma * m
    return mass, m.diff(t) + second.diff(x) - gamma * second - rho * g


@pytest.mark.parametrize("force", [lambda: quadratic(xi, rho, u, gamma, g, HALF), lambda: affine(xi, rho, u, gamma, g)])
def test_theorem_2(force) -> None:
    """The moments of M_t + xi M_x + F M_xi are the residuals of (14), whatever rho, u, beta and g are."""
    F = force()
    for k, residual in enumerate(residuals_of_14()):
        left = moment(xi**k).diff(t) + moment(xi ** (k + 1)).diff(x) - moment((xi**k * F).diff(xi))
        assert sp.simplify(left - residual) == 0


def test_theorem_2_needs_its_half() -> None:
    """With another c than 1/2 the moments are not those of (14): c = 1/2 is found, not assumed."""
    F = quadratic(xi, rho, u, gamma, g, c)
    mass, momentum = residuals_of_14()
    off = sp.simplify(moment(1 + 0 * xi).diff(t) + moment(xi).diff(x) - moment(F.diff(xi)) - mass)
    assert sp.solve(off, c) == [HALF]
    left = moment(xi).diff(t) + moment(xi**2).diff(x) - moment((xi * F).diff(xi))
    assert sp.solve(sp.simplify(left - momentum), c) == [HALF]


def test_theorem_a() -> None:
    """In conservative form, with the density of h and the local beta, every c gives the residuals of (13)."""
    h = rho / beta
    F = quadratic(xi, rho, u, gamma, g, c)
    mass = h.diff(t) + (h * u).diff(x)
    momentum = (h * u).diff(t) + (h * u**2 + beta * h**2 / 2).diff(x) - g * h
    for k, residual in enumerate((mass, momentum)):
        density = [moment(xi**n) / beta for n in (k, k + 1)]
        pushed = moment((xi**k).diff(xi) * F) / beta if k else sp.Integer(0)
        assert sp.simplify(density[0].diff(t) + density[1].diff(x) - pushed - residual) == 0


def at_rest(F: sp.Expr, scale: sp.Expr, conservative: bool) -> sp.Expr:
    """Q where u = 0 and rho_x = g + gamma rho/2, of the density M/scale."""
    R, b = sp.Function("R", positive=True)(x), sp.Function("b", positive=True)(x)
    density = sp.sqrt(2 * R - xi**2) / sp.pi / scale.subs(beta, b)
    force = (F * density).diff(xi) if conservative else F * density.diff(xi)
    Q = (xi * density.diff(x) + force).subs(R.diff(x), g + b.diff(x) / b * R / 2)
    numbers = sp.symbols("rho_ beta_ gamma_")
    return Q.subs(b.diff(x), numbers[2] * b).subs({R: numbers[0], b: numbers[1]})


def force_at_rest(which: str, c: sp.Expr) -> sp.Expr:
    R, b = sp.Function("R", positive=True)(x), sp.Function("b", positive=True)(x)
    slope = b.diff(x) / b
    return affine(xi, R, sp.Integer(0), slope, g) if which == "affine" else quadratic(xi, R, 0, slope, g, c)


def test_Q_at_rest(rng: np.random.Generator) -> None:
    """The closed forms of Q at random places against its definition; g drops out."""
    names = (xi, *sp.symbols("rho_ beta_ gamma_"), g, c)
    of_17 = sp.lambdify(names, at_rest(force_at_rest("17", HALF), sp.Integer(1), False))
    family = sp.lambdify(names, at_rest(force_at_rest("family", c), beta, True))
    for _ in range(50):
        r, b, slope, pull, share = (*rng.uniform(0.2, 2, 2), *rng.uniform(-1, 1, 2), rng.uniform(-1, 2))
        v = rng.uniform(-0.95, 0.95) * np.sqrt(2 * r)
        assert residual_of_17(v, r, slope) == pytest.approx(of_17(v, r, b, slope, pull, share), rel=1e-11, abs=1e-12)
        expected = family(v, r, b, slope, pull, share)
        assert residual_of_family(v, r, b, slope, share) == pytest.approx(expected, rel=1e-11, abs=1e-11)
    assert residual_of_17(2.0, 1.0, 1.0) == 0.0


def test_two_forces_keep_rest_pointwise() -> None:
    third = sp.Rational(1, 3)
    assert sp.simplify(at_rest(force_at_rest("affine", HALF), sp.Integer(1), False)) == 0
    assert sp.simplify(at_rest(force_at_rest("family", third), beta, True)) == 0
    found = at_rest(force_at_rest("family", c), beta, True).subs(xi, 1).subs("rho_", 1)
    assert sp.solve(sp.simplify(found), c) == [third]


def test_17_has_no_equilibrium_at_rest() -> None:
    """No chi at all makes Q of (17) vanish at rest for every g and gamma: the two ask for different shapes."""
    shape, R, slope = sp.Function("chi")(w), sp.Symbol("R", positive=True), sp.Symbol("gamma_")
    M_x = (g + slope * R / 2) / (2 * sp.sqrt(R)) * (shape - w * shape.diff(w))
    Q = sp.expand(sp.sqrt(R) * w * M_x + quadratic(sp.sqrt(R) * w, R, 0, slope, g, HALF) * shape.diff(w))
    by_g, by_gamma = (sp.solve(Q.coeff(s), shape.diff(w))[0] / shape for s in (g, slope))
    assert sp.simplify(by_g - sp.log(CHI).diff(w)) == 0
    assert sp.simplify(by_gamma - w / (1 - w**2)) == 0


STATES = [
    (0.4, 0.9, -0.7, 0.3, 0.12), (0.4, 0.9, 0.7, 0.3, 0.12), (0.02, -2.0, 0.4, -1.0, 0.2), (1.3, 0.0, -0.9, 0.2, 0.1),
    (0.7, 1.5, 0.0, 0.4, 0.3), (0.5, 0.3, 1e-9, 0.4, 0.3), (0.6, -0.4, 0.5, 0.25 * (0.16 + 0.3), 0.25),
]  # fmt: skip
"""rho, u, gamma, g, dt: B of both signs, no bend, hardly one, and B = 0 in (17)."""


def make(state: tuple[float, ...], c: float = 0.5) -> Riccati:
    r, v, slope, pull, dt = state
    return riccati(r, v, slope, pull, c, dt)


def test_states_have_both_signs_of_B_and_zero() -> None:
    sizes = [make(state).BS * make(state).S for state in STATES]
    assert min(sizes) < 0.0 < max(sizes)
    assert pytest.approx(0.0, abs=1e-17) == make(STATES[-1]).BS


@pytest.mark.parametrize("state", STATES)
def test_the_map_is_the_flow_of_the_force(state: tuple[float, ...]) -> None:
    r, v, slope, pull, dt = state
    start, tiny = v + np.sqrt(2 * r) * np.linspace(-1, 1, 5), 1e-6
    for share in (0.5, 1 / 3, 1.0):
        flow = solve_ivp(
            lambda _, y, share: quadratic(y, r, v, slope, pull, share),
            (0, dt), start, "DOP853", args=(share,), rtol=1e-13, atol=1e-14,
        )  # fmt: skip
        phi = make(state, share)
        assert phi(start) == pytest.approx(flow.y[:, -1], rel=0, abs=1e-11)
        assert phi.inverse(phi(start)) == pytest.approx(start, rel=0, abs=4e-15)
        assert pytest.approx(1.0, abs=4e-16) == phi.C**2 + phi.S * phi.BS
        assert phi.slope(start) == pytest.approx((phi(start + tiny) - phi(start - tiny)) / (2 * tiny), rel=1e-8)


@pytest.mark.parametrize("state", STATES)
def test_image_of_an_equilibrium(state: tuple[float, ...]) -> None:
    """Its moments by quadrature: of the image itself where values are carried, of Phi where particles are pushed."""
    r, v = state[:2]
    phi, half = make(state), np.sqrt(2 * r)
    ends = phi(v - half), phi(v + half)
    middle, reach = 0.5 * (ends[0] + ends[1]), 0.5 * (ends[1] - ends[0])

    def image(k: int) -> float:
        def integrand(a: float) -> float:
            y = middle + reach * np.sin(a)
            return float(equilibrium(phi.inverse(y), r, v) * y**k * reach * np.cos(a))

        return quad(integrand, -np.pi / 2, np.pi / 2, epsabs=1e-13, epsrel=1e-13)[0]

    assert phi.carried(r, v) == (pytest.approx(image(0), rel=1e-10), pytest.approx(image(1), rel=1e-10, abs=1e-12))
    mean = quad(lambda a: float(phi(v + half * np.sin(a))) * 2 * np.cos(a) ** 2 / np.pi, -np.pi / 2, np.pi / 2)[0]
    assert phi.pushed(r, v) == pytest.approx(mean, rel=1e-11, abs=1e-12)


def printed_moments(phi: Riccati, r: float, v: float) -> tuple[float, float]:
    """rho+ and m+ as one would write them down, with S in the denominator."""
    C, S = float(phi.C), float(phi.S)
    a = C - v * S
    d = np.sqrt(a * a - 2 * r * S * S)
    return 2 * r / (d * (a + d)), r / S * (a + d - 2 * C * d * d) / (d**3 * (a + d))


def test_moments_as_one_would_write_them_down() -> None:
    for state in STATES[:4]:
        phi = make(state)
        assert phi.carried(*state[:2]) == pytest.approx(printed_moments(phi, *state[:2]), rel=1e-11)


def test_limits() -> None:
    """No bend is the rigid shift, to the last bit; through B = 0 and gamma = 0 the map is smooth."""
    r, v, _, pull, dt = STATES[0]
    rigid = riccati(r, v, 0.0, pull, 0.5, dt)
    assert [1.0, 0.0, pull * dt] == [rigid.C, rigid.S, rigid.BS]
    assert rigid.carried(r, v) == pytest.approx((r, r * (v + pull * dt)), rel=1e-15)
    assert rigid.pushed(r, v) == pytest.approx(v + pull * dt, rel=1e-15)
    assert rigid(0.3) == riccati(r, v, 0.8, pull, 0.0, dt)(0.3) == 0.3 + pull * dt
    slope, zero = 0.6, 0.3 * (v * v + r / 2)  # g = gamma A / 2 makes B = 0
    tau = 0.5 * slope * dt
    xi0 = np.linspace(-1, 2, 7)
    for off in (0.0, 1e-16, -1e-16, 1e-9, -1e-9):
        phi = riccati(r, v, slope, zero + off, 0.5, dt)
        assert phi(xi0) == pytest.approx(xi0 / (1 - tau * xi0), rel=0, abs=1e-15 + 2 * abs(off) * dt)


def test_short_steps_have_the_rates_of_14() -> None:
    """(rho+ - rho)/dt and (m+ - m)/dt approach the right side of (14), with order 1."""
    r, v, slope, pull, _ = STATES[0]
    m, second = r * v, r * v * v + r * r / 2
    for images in (
        lambda dt: riccati(r, v, slope, pull, 0.5, dt).carried(r, v),
        lambda dt: affine_map(r, v, slope, pull, dt).carried(r, m),
    ):
        off = [
            np.abs((np.array(images(dt)) - [r, m]) / dt - [slope * m, slope * second + r * pull]) for dt in (1e-3, 5e-4)
        ]
        assert off[0] / off[1] == pytest.approx(2.0, abs=0.01)


@pytest.mark.parametrize("state", STATES)
def test_affine_map(state: tuple[float, ...]) -> None:
    """It is the flow of its force, and takes the moments of any density, here of two blocks."""
    r, v, slope, pull, dt = state
    phi, start = affine_map(r, v, slope, pull, dt), np.array([-1.0, 0.2, 3.0])
    flow = solve_ivp(lambda _, y: affine(y, r, v, slope, pull), (0, dt), start, "DOP853", rtol=1e-13, atol=1e-14)
    assert phi(start) == pytest.approx(flow.y[:, -1], rel=0, abs=1e-11)
    edges, heights = np.array([[-1.0, 0.5], [0.7, 0.9]]), np.array([0.4, 2.0])
    moments = [(heights * (edges[:, 1] ** k - edges[:, 0] ** k) / k).sum() for k in (1, 2)]
    after = [(heights * (phi(edges[:, 1]) ** k - phi(edges[:, 0]) ** k) / k).sum() for k in (1, 2)]
    assert phi.carried(*moments) == pytest.approx(after, rel=1e-14)
    assert (phi.slope(start) == phi.scale).all()


def test_refusals() -> None:
    refuse_steep([0.1, -STEEPEST / 0.5], 0.5)
    for slope in (0.7, -0.7, np.nan):
        with pytest.raises(InputError, match=r"in cell 2, more than 0.2; take cells of at most"):
            refuse_steep(np.array([0.1, 0.2, slope]), 0.5)
    with pytest.raises(InputError, match="take a shorter dt"):
        make((0.5, 2.0, 1.0, 0.0, 3.0)).carried(0.5, 2.0)
    with pytest.raises(InputError, match="take a shorter dt"):
        make((0.5, 2.0, 1.0, 0.0, 3.0)).pushed(0.5, 2.0)
