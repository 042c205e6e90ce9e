"""No arrays are made in the time loop."""

from __future__ import annotations

import tracemalloc

import pytest

from kinsim import Blocks, Cells, ConstantSlope, Coulomb, Fitted, Kinetic, Macroscopic, Scene, Uniform
from kinsim.stepper import make_stepper
from kinsim.watch.survey import Survey

METHODS = {
    f"{name}, scheme {scheme}": method
    for scheme in (1, 4)
    for name, method in (
        ("closed form", Macroscopic(scheme)),
        ("fitted", Kinetic(scheme, Fitted(4))),
        ("grid", Kinetic(scheme, Uniform(16, 3.0))),
    )
}
CELLS, HANDLES = 20000, 5000
"""A row of flags takes 20 kB; so many bytes Python needs to name the arrays of a few steps."""


@pytest.mark.parametrize("name", METHODS)
def test_a_step_makes_no_array(name: str) -> None:
    """Not even one for a moment: neither left behind nor at the peak."""
    scene = Scene(Cells(-1, 1, CELLS), Blocks((-0.4, 0.3), (0.1, 1, 0)), ConstantSlope(0.3), Coulomb(0.25), epsilon=0.4)
    stepper = make_stepper(scene, METHODS[name])
    h, q = scene.initial()

    def step() -> None:
        stepper.begin(h, q)
        stepper.advance(1e-5)
        Survey.of(stepper.now.h1, stepper.now.q1, scene.beta)
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
