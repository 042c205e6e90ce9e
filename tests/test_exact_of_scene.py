"""Which scenes have an exact solution, and that it lies on their pictures."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from kinsim import Blocks, ConstantSlope, Coulomb, Expression, Fixed, Macroscopic, load_scene, simulate
from kinsim.exact import AcceleratedRiemann, Riemann, UniformSlide
from kinsim.exact.of_scene import exact_of
from kinsim.plot import draw


def test_two_blocks_have_one() -> None:
    scene, _, _ = load_scene("riemann")
    found = exact_of(scene)
    assert found == Riemann(1.0, 0.0, 0.5, 0.0, beta=0.4, x0=0.0)
    np.testing.assert_array_equal(found(scene.x, 0.0)[0], scene.initial()[0])
    steep = replace(scene, chute=ConstantSlope(0.5), friction=Coulomb(0.3))
    assert isinstance(exact_of(steep), AcceleratedRiemann)


def test_blocks_that_move_have_one_unless_friction_meets_both_signs() -> None:
    scene, _, _ = load_scene("riemann")
    moving = replace(scene, heap=Blocks((0.5,), (1.0, 0.4), (0.3, -0.1)))
    found = exact_of(moving)
    assert found == Riemann(1.0, 0.3, 0.4, -0.1, beta=0.4, x0=0.5)
    h, q = moving.initial()
    np.testing.assert_array_equal(found(scene.x, 0.0)[0], h)
    np.testing.assert_allclose(found(scene.x, 0.0)[1], q / h, rtol=1e-15)
    run = simulate(moving, Macroscopic(4, order=2), Fixed(1e-2, 100), 100)
    still = simulate(replace(moving, heap=Blocks((0.5,), (1.0, 0.4))), Macroscopic(4, order=2), Fixed(1e-2, 100), 100)
    near, far = (np.abs(one.h[-1] - found(scene.x, 1.0)[0]).mean() for one in (run, still))
    assert near < 0.1 * far
    assert exact_of(replace(moving, friction=Coulomb(0.3))) is None
    steep = replace(
        moving, chute=ConstantSlope(0.5), friction=Coulomb(0.3), heap=Blocks((0.5,), (1.0, 0.4), (2.0, 1.9))
    )
    assert isinstance(exact_of(steep), AcceleratedRiemann)


def test_a_layer_that_is_the_same_everywhere_slides() -> None:
    """However it is written; the picture of its run has the overlay."""
    scene, _, _ = load_scene("riemann")
    layer = replace(scene, heap=Blocks((), (0.7,)), chute=ConstantSlope(0.5), friction=Coulomb(0.3))
    found = exact_of(layer)
    assert found == UniformSlide(0.0, layer.chute.sin, layer.resistance, 0.7)
    for boundary in ("open", "periodic"):
        moving = replace(layer, heap=Expression("1.5", "0.2"), boundary=boundary)
        assert exact_of(moving) == UniformSlide(0.2, layer.chute.sin, layer.resistance, 1.5)
        run = simulate(moving, Macroscopic(1), Fixed(1e-2, 50), 25)
        np.testing.assert_allclose(run.u[-1], exact_of(moving)(run.x, 0.5)[1], rtol=1e-13)
        heights = draw(run).axes[0]
        assert [line for line in heights.lines if line.get_linestyle() == "--"]
    assert exact_of(replace(layer, boundary="wall")) is None
    assert exact_of(replace(layer, heap=Blocks((), (0.0,)))) is None
    assert exact_of(replace(layer, heap=Expression("1.5", "0.2 + 0.1*x"))) is None


def test_others_have_none() -> None:
    scene, _, _ = load_scene("riemann")
    assert exact_of(load_scene("silo")[0]) is None
    assert exact_of(load_scene("sine")[0]) is None
    assert exact_of(replace(scene, friction=Coulomb(0.3))) is None
    assert exact_of(replace(scene, boundary="periodic")) is None
    assert exact_of(replace(scene, boundary=("open", "wall"))) is None
    assert exact_of(replace(scene, heap=Blocks((-1, 1), (1, 2, 1)))) is None


def test_it_lies_on_the_picture() -> None:
    """One dashed curve for each later time, close to the run; none where there is no solution."""
    scene, _, _ = load_scene("riemann")
    heights = draw(simulate(scene, Macroscopic(1), Fixed(1e-2, 200), 20)).axes[0]
    dashed = [line for line in heights.lines if line.get_linestyle() == "--"]
    assert len(dashed) == len(heights.lines) // 2
    assert "exact" in [text.get_text() for text in heights.get_legend().get_texts()]
    run, exact = heights.lines[-2], dashed[-1]
    off = np.abs(run.get_ydata() - np.interp(run.get_xdata(), exact.get_xdata(), exact.get_ydata()))
    assert off.mean() <= 0.01
    silo = draw(simulate(load_scene("silo")[0], Macroscopic(1), Fixed(1e-3, 20), 20)).axes[0]
    assert not [line for line in silo.lines if line.get_linestyle() == "--"]
