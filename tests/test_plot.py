"""Pictures: what is drawn, and that half a picture never bears the final name."""

from __future__ import annotations

import numpy as np
import pytest
from conftest import SCENES

from kinsim import Dump, Fixed, InputError, Kinetic, Macroscopic, Uniform, simulate
from kinsim.plot import draw, plot_run, telling_rows
from kinsim.plot.density import draw_density

METHODS = {"kinetic": Kinetic(3, Uniform(32)), "macroscopic": Macroscopic(3)}
SIGNATURES = {"png": b"\x89PNG", "pdf": b"%PDF", "svg": b"<?xml"}


def small_run(method, scene="silo", steps=100, dumps=()):
    return simulate(SCENES[scene][0], method, Fixed(1e-2, steps), save_every=5, dumps=dumps)


@pytest.fixture(scope="module")
def run():
    return small_run(METHODS["macroscopic"])


@pytest.mark.parametrize("suffix", SIGNATURES)
def test_the_suffix_chooses_the_format(tmp_path, run, suffix):
    path = plot_run(run, tmp_path / f"run.{suffix}")
    assert path.read_bytes().startswith(SIGNATURES[suffix])
    assert [entry.name for entry in tmp_path.iterdir()] == [path.name]


def test_h_and_u_are_drawn_from_the_first_to_the_last_state(run):
    heights, velocities, *_ = draw(run).axes
    assert len(heights.lines) == len(velocities.lines) == 6
    for axes, values in ((heights, run.h), (velocities, run.u)):
        np.testing.assert_array_equal(axes.lines[0].get_ydata(), values[0])
        np.testing.assert_array_equal(axes.lines[-1].get_ydata(), values[-1])
    labels = [text.get_text() for text in heights.get_legend().get_texts()]
    assert labels[0] == "t = 0"
    assert labels[-1] == "t = 1"


@pytest.mark.parametrize("name", METHODS)
def test_the_density_fills_its_support(name):
    dumps = [Dump(every=10**6)] if name == "kinetic" else []
    run = small_run(METHODS[name], dumps=dumps)
    phase = draw(run).axes[2]
    c = np.sqrt(2 * run.scene.beta * run.h[-1])
    np.testing.assert_allclose(phase.lines[0].get_ydata(), run.u[-1] + c)
    np.testing.assert_allclose(phase.lines[1].get_ydata(), run.u[-1] - c)
    image = phase.collections[0]
    f = image.get_array()
    assert f.max() == pytest.approx(np.sqrt(2 * run.h[-1].max() / run.scene.beta) / np.pi, rel=0.05)
    assert f.shape == ((32, 320) if name == "kinetic" else (401, 320))
    low, high = phase.get_ylim()
    assert low < (run.u[-1] - c).min()
    assert high > (run.u[-1] + c).max()


def test_a_density_of_another_stage_or_time_is_not_shown_as_the_last():
    before_the_force = small_run(METHODS["kinetic"], dumps=[Dump(stage="transport")])
    narrow = [Kinetic(3, Uniform(32, bound)) for bound in (1.0, 1.5)]
    stopped = [small_run(method, dumps=[Dump()]) for method in narrow]
    assert [run.dumps["f"].sizes["t"] for run in stopped] == [0, 1]
    assert stopped[1].steps > 1
    for run in (before_the_force, *stopped):
        assert "equilibrium" in draw(run).axes[-1].get_ylabel()


def test_the_chosen_rows_share_out_the_change():
    h = np.concatenate([[0.0], np.linspace(0.0, 1.0, 11), np.ones(50)])[:, None] * np.ones(3)
    assert telling_rows(h, 6) == [0, 3, 5, 7, 9, 61]
    assert telling_rows(h[:1], 6) == [0]
    assert telling_rows(np.ones((9, 3)), 6) == [0, 8]


def test_a_dry_and_a_still_scene_can_be_drawn(tmp_path):
    from dataclasses import replace

    from kinsim import Blocks

    scene = replace(SCENES["riemann"][0], heap=Blocks((), (0.0,)))
    plot_run(simulate(scene, Macroscopic(), Fixed(1e-2, 1)), tmp_path / "dry.png")


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("run.gif", "is no picture; end its name in .png, .pdf, .svg"),
        ("run", "is no picture"),
        ("no/run.png", "does not exist"),
    ],
)
def test_bad_destinations(tmp_path, run, name, wanted):
    with pytest.raises(InputError, match=wanted):
        plot_run(run, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_failure_leaves_the_old_picture(tmp_path, run, monkeypatch):
    path = tmp_path / "run.png"
    path.write_text("old")

    def fail(self, name, **_):
        with open(name, "w") as file:
            file.write("half")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", fail)
    with pytest.raises(InputError, match=r"run\.png: cannot be written \(No space left on device\)"):
        plot_run(run, path)
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]


def test_what_faces_hold_back_is_cut_out_of_m():
    """The filled shell lies between M less what is held, and M."""
    dump = Dump("back", "held", every=10**6)
    run = small_run(Kinetic(4, Uniform(32), "matched"), dumps=[dump])
    back = run.dumps["back"]
    cell = int(back[-1].to_numpy().sum(axis=1).argmax())
    figure = draw_density(run, back, [float(back["x"][cell])])
    cut = next(axes for axes in figure.axes if axes.get_title().startswith("cut"))
    values, _, base = cut.patches[0].get_data()
    held = back[-1, cell].to_numpy()
    np.testing.assert_allclose((values - base)[base > 0], held[base > 0], atol=1e-15)
    assert held.max() > 0
    assert any("held back" in axes.get_ylabel() for axes in figure.axes)
