"""The atlas says what became of a run, and can tell."""

from __future__ import annotations

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

from kinsim import Courant, Fitted, InputError, Kinetic, Macroscopic, Uniform, atlas, simulate
from kinsim.cli import app
from kinsim.plot.atlas import draw_atlas
from kinsim.stability.axes import AXES, USUAL
from kinsim.stability.judge import CLASSES, growth, judge, rise, zigzag
from kinsim.stability.setting import Setting


def test_no_point_of_scheme_4_oscillates() -> None:
    """Along all axes, closed form; the bound (28) kept."""
    found = atlas(Macroscopic(4), [name for name in USUAL if name != "courant"], steps=60)
    assert set(found["class"].to_numpy()) <= {"exact", "stable"}
    assert float(found["drift"].max()) <= 1e-14
    assert float(found["least"].min()) >= 0.0


def test_it_sees_what_the_printed_schemes_do() -> None:
    """Scheme 1 shakes a thin layer, scheme 2 blows up, scheme 3 makes mass; each for its own reason."""
    one = atlas(Macroscopic(1), ["height"], steps=60)
    assert one["class"].to_numpy()[one["value"].to_numpy() == "1e-12"] == "oscillating"
    assert float(one["rise"].max()) > 0.1
    two = atlas(Macroscopic(2), ["ratio"], steps=100)
    assert (two["class"].to_numpy() == "oscillating").sum() >= 5
    assert float(two["least"].min()) < -1e-3
    three = atlas(Macroscopic(3), ["mass"], steps=60)
    assert three["class"].to_numpy()[0] == "repaired"
    assert float(three["drift"].max()) > 1e-3


def test_beyond_the_bound_on_demand_only() -> None:
    """The axis of the Courant number goes there, and finds the end of stability; a plane carries it on."""
    found = atlas(Macroscopic(1), [("courant", "cells")], steps=60)
    words = found["class"].to_numpy()
    numbers = np.array([float(value) for value in found["value"].to_numpy()])
    assert (words[numbers == 3.0] == "oscillating").any()
    assert not (words[numbers <= 1.0] == "oscillating").any()
    assert found.sizes["point"] == len(AXES["courant"].values) * len(AXES["cells"].values)
    figure = draw_atlas(found)
    assert any("limit 1" in text.get_text() for text in figure.axes[0].texts)


def test_what_cannot_be_built_is_a_point_that_is_refused() -> None:
    """Matched equilibria need four nodes; the others go on."""
    found = atlas(Kinetic(4, Uniform(8), "matched"), ["nodes"], steps=20)
    words = found["class"].to_numpy()
    assert words[0] == "refused"
    assert "at least 4" in str(found["verdict"].to_numpy()[0])
    assert (words[4:] != "refused").all()
    assert "nodes" not in atlas(Kinetic(4, Fitted(3)), ["nodes", "mass"], steps=20)["axis"].to_numpy()


def test_finished_points_are_kept(tmp_path: Path) -> None:
    """A second call with resume runs nothing anew."""
    first = atlas(Macroscopic(4), ["mass"], steps=20, keep=tmp_path)
    before = {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    again = atlas(Macroscopic(4), ["mass"], steps=20, keep=tmp_path, resume=True)
    assert before == {path: path.stat().st_mtime_ns for path in tmp_path.iterdir()}
    assert again.identical(first)


def test_the_words_follow_from_the_measures() -> None:
    """Histories made by hand: a disturbance that grows, energy that rises, a fall of one cell, heights below 0."""
    setting = Setting(Macroscopic(4), zeta=0.0, delta=0.0)
    h = np.ones((3, 40)) + np.linspace(0, 0.1, 40)
    q = np.zeros_like(h)
    run = {"verdict_kind": "finished", "mass_drift": 0.0, "history_h": h, "history_q": q}

    def word(**changes: object) -> str:
        return judge(lambda: setting, run | changes, {"verdict_kind": "finished", "history_h": h + 1e-9})[0]

    assert word() == "exact"
    moved = np.stack([q[0], q[0], q[0] + 1e-9])
    assert word(history_q=moved) == "stable"
    assert word(history_q=moved, window_loss=1e-6) == "repaired"
    assert word(history_q=moved, fallbacks=1.0) == "repaired"
    assert word(history_q=np.stack([q[0], q[0], q[0] + 0.1])) == "oscillating"
    assert word(history_h=h - np.eye(3, 40) * 1.5) == "oscillating"
    assert word(verdict_kind="too-many-steps") == "oscillating"
    assert word(history_q=moved, mass_drift=0.9) == "oscillating"
    assert word(history_q=moved, mass_drift=1e-6, coupling_drift=1e-6 * h[0].sum() * 0.05) == "repaired"
    assert word(verdict_kind="refused") == "refused"
    assert word(verdict_kind="non-finite") == "non-finite"
    tiny = np.zeros((3, 40))
    tiny[0] = 1e-9
    assert growth(h, h + tiny) == pytest.approx(1.0)
    tiny[2, 7] = 1e-3
    assert growth(h, h + tiny) == pytest.approx(1e6, rel=1e-3)
    assert set(CLASSES) >= {word(), "stable"}
    steep = Setting(Macroscopic(4), zeta=0.5).scene
    fallen = np.zeros((2, 40))
    fallen[0, 20], fallen[1, 19] = 1.0, 1.0  # back by a cell: as far as nobody can tell
    assert rise(steep, fallen, 0 * fallen) == 0.0
    fallen[1] = np.roll(fallen[1], -3)
    assert rise(steep, fallen, 0 * fallen) > 0.05


def test_mass_that_summing_anew_forgets_is_booked() -> None:
    """U summed anew from few sampled nodes forgets a thin layer altogether; the atlas finds it in the books."""
    found = atlas(Kinetic(4, Uniform(8), "sampled", projection="re-summed"), ["height"], steps=30)
    lost = found["drift"].to_numpy() > 1e-6
    assert lost.any()
    assert set(found["class"].to_numpy()[lost]) <= {"repaired", "oscillating"}
    assert "repaired" in found["class"].to_numpy()[lost]


def test_a_zigzag_is_seen_and_a_pile_at_a_wall_is_not() -> None:
    """Total variation rises in both; what is up and down from cell to cell is told apart."""
    pile = np.zeros((2, 40))
    pile[0], pile[1, 0] = 0.025, 1.0
    assert zigzag(pile) == pytest.approx(0.25)
    waves = 1.0 + 0.02 * np.stack([0.0 * np.arange(40), (-1.0) ** np.arange(40)])
    assert zigzag(waves) > 1.0
    assert zigzag(np.tile(np.linspace(1.0, 2.0, 40) ** 3, (2, 1))) == 0.0


def test_the_axis_of_steps_goes_on_for_long() -> None:
    """5000 times the steps of other axes, which is a million where those take 200: stable, and no mass drifts."""
    found = atlas(Macroscopic(4), ["steps"], steps=10)
    assert set(found["class"].to_numpy()) == {"stable"}
    assert float(found["drift"].max()) <= 1e-12
    assert replace(Setting(Macroscopic(4), steps=10), times=5000.0).clock.end == pytest.approx(
        5000.0 * Setting(Macroscopic(4), steps=10).clock.end, rel=1.0
    )


def test_a_grain_at_rest_on_a_steep_chute_does_not_jump() -> None:
    """A Courant clock limits the first steps, too: the energy that a fall gives is that of the fall."""
    setting = Setting(Macroscopic(4), zeta=math.radians(89.9), froude=0.0)
    run = simulate(setting.scene, setting.method, setting.clock, 1)
    first = run.dt[0]
    s, R = setting.scene.chute.sin, setting.scene.resistance
    assert 0.5 * (s - R) * first**2 <= 0.9 * setting.scene.cells.dx * (1 + 1e-12)
    assert rise(setting.scene, run.h, run.q) <= 0.01


def test_a_run_ends() -> None:
    """`most` steps are not passed; the verdict says so, with the step."""
    run = simulate(Setting(Macroscopic(4)).scene, Macroscopic(4), Courant(0.5, 1e3, most=7))
    assert run.steps == 7
    assert run.verdict.kind == "too-many-steps"
    assert str(run.verdict).startswith("step 8:")


def test_from_the_shell(tmp_path: Path) -> None:
    """A table, a map, a file; bad axes and settings in one line."""
    files = tmp_path / "a.nc", tmp_path / "a.png"
    words = ["atlas", "--steps", "10", "--axis", "mass", "--plane", "mass,mass", "--out", str(files[0])]
    done = CliRunner().invoke(app, [*words, "--plot", str(files[1])])
    assert done.exit_code == 0, done.stderr
    assert "mass over mass" in done.stdout
    assert all(file.stat().st_size > 1000 for file in files)
    for bad in (["--axis", "no"], ["--plane", "cells"], ["--set", "cells.count=3"], ["--set", "method.scheme=7"],
                ["--resume"]):  # fmt: skip
        refused = CliRunner().invoke(app, ["atlas", *bad])
        assert refused.exit_code == 2
        assert len(refused.stderr.strip().splitlines()) == 1
    with pytest.raises(InputError, match="unknown"):
        atlas(Macroscopic(4), ["no"])
