"""No arrays are made in the time loop."""

from __future__ import annotations

import tracemalloc

import pytest

from kinsim import (
    Arc,
    Blocks,
    Cells,
    ConstantSlope,
    Coulomb,
    Fitted,
    Kinetic,
    Macroscopic,
    Scene,
    SmoothChute,
    Uniform,
    Window,
)  # fmt: skip
from kinsim.stepper import make_stepper
from kinsim.watch.survey import Survey


def on_a_grid(**chosen: object) -> Kinetic:
    return Kinetic(velocity=Uniform(16, 3.0), **chosen)


METHODS = {
    f"{name}, scheme {scheme}": method
    for scheme in (1, 2, 3, 4)
    for name, method in (
        ("closed form", Macroscopic(scheme)),
        ("fitted", Kinetic(scheme, Fitted(4))),
        ("grid", on_a_grid(scheme=scheme)),
    )
} | {
    "closed form, by face": Macroscopic(3, coupling="face"),
    "closed form, order 2": Macroscopic(order=2),
    "fitted, order 2": Kinetic(velocity=Fitted(4), order=2),
    "grid, order 2": on_a_grid(order=2),
    "closed form, reflecting": Macroscopic(statics="reflect"),
    "grid, reflecting": on_a_grid(statics="reflect"),
    "grid, matched": on_a_grid(equilibrium="matched"),
    "grid, entropic": on_a_grid(equilibrium="entropic"),
    "grid, exact shift": on_a_grid(force="shift-exact"),
    "grid, parabolas": on_a_grid(force="shift-pfc"),
    "grid, derivative": on_a_grid(force="derivative-upwind"),
    "grid, re-summed": on_a_grid(projection="re-summed"),
    "window": Kinetic(velocity=Window(0.2)),
}
ON_A_BEND = ("closed form, scheme 4", "closed form, order 2", "closed form, reflecting", "grid, scheme 4")
CASES = [(name, ConstantSlope(0.3)) for name in METHODS]
CASES += [(name, SmoothChute(Arc(9.0, 0.3), 1.0)) for name in ON_A_BEND]
CELLS, HANDLES = 20000, 5000
"""A row of flags takes 20 kB; so many bytes Python needs to name the arrays of a few steps."""


@pytest.mark.parametrize(("name", "chute"), CASES, ids=lambda case: case if isinstance(case, str) else case.kind)
def test_a_step_makes_no_array(name: str, chute: ConstantSlope | SmoothChute) -> None:
    """Not even one for a moment: neither left behind nor at the peak."""
    scene = Scene(Cells(-1, 1, CELLS), Blocks((-0.4, 0.3), (0.1, 1, 0)), chute, Coulomb(0.25), epsilon=0.4)
    stepper = make_stepper(scene, METHODS[name])
    h, q = scene.initial()
    beta = scene.beta

    def step() -> None:
        stepper.begin(h, q)
        stepper.advance(1e-5)
        Survey.of(stepper.now.h1, stepper.now.q1, beta)
        h[:], q[:] = stepper.now.h1, stepper.now.q1

    for _ in range(3):
        step()
    tracemalloc.start()
    step()
    before = tracemalloc.get_traced_memory()[0]
    tracemalloc.reset_peak()
    for _ in range(5):
        step()
    after, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert after - before < HANDLES
    assert peak - before < HANDLES
