"""Films: their frames show the rows of a run, each kind of file holds them all, and bad requests leave nothing."""

from __future__ import annotations

import base64
import io
import itertools
import json
import os
import re
import stat
from dataclasses import replace

import numpy as np
import pytest
from conftest import SCENES
from PIL import Image
from test_cli import folder, kinsim, written  # noqa: F401

from kinsim import Dump, InputError, Kinetic, Uniform, animate, simulate
from kinsim.clock import Fixed
from kinsim.film.reel import equilibrium, reel_of
from kinsim.film.shoot import shoot
from kinsim.film.stored import read_reel
from kinsim.plot.film import Pictures
from kinsim.read import check, read_keys

SCENE = SCENES["silo"][0]
METHOD = Kinetic(3, Uniform(16))
SMALL = {"frames": 5, "width": 240}


@pytest.fixture(scope="module")
def run():
    return simulate(SCENE, METHOD, Fixed(1e-2, 40), save_every=4, dumps=[Dump(every=4)])


@pytest.fixture(scope="module")
def closed():
    return simulate(SCENE, METHOD.twin, Fixed(1e-2, 40), save_every=4)


def test_a_gif_has_every_frame_and_they_differ(tmp_path, run, closed):
    shares = []
    path = animate(run, tmp_path / "film.gif", twin=closed, **SMALL, rate=10, progress=shares.append)
    with Image.open(path) as film:
        assert (film.n_frames, film.width, film.info["duration"], film.info["loop"]) == (5, 240, 100, 0)
        frames = []
        for number in range(film.n_frames):
            film.seek(number)
            frames.append(np.asarray(film.convert("RGB")))
    assert all((one != two).any(axis=2).mean() > 0.001 for one, two in itertools.pairwise(frames))
    assert (frames[0][0, 120] == 255).all()  # paper stays white
    assert shares == sorted(shares)
    assert len(shares) == 5
    assert written(tmp_path) == {"film.gif"}


def test_a_page_holds_all_frames_a_scrub_bar_and_fetches_nothing(tmp_path, run):
    scene = replace(SCENE, title='<b>"steep" & dry')
    page = animate(replace(run, scene=scene), tmp_path / "film.html", **SMALL).read_text()
    assert not re.search(r"https?:|src=|href=|url\(|@import|fetch\(|<b>", page)
    assert '<input id="scrub" type="range" min="0" max="4"' in page
    assert "default-src 'none'" in page
    frames, times = (json.loads(re.search(rf"^const {name} = (.*);$", page, re.M)[1]) for name in ("frames", "times"))
    assert len(set(frames)) == 5
    np.testing.assert_allclose(times, np.linspace(0, 0.4, 5), atol=0.021)
    for frame in frames:
        assert Image.open(io.BytesIO(base64.b64decode(frame))).width == 240


def test_frames_show_the_rows_of_the_run(run, closed):
    reel = reel_of(run, 600, closed)
    np.testing.assert_array_equal(reel.t, run.t)
    np.testing.assert_array_equal(reel.density.f[1:], run.dumps["f"][1:])  # the dump begins with the first step
    start = equilibrium(run.h[0], run.u[0], SCENE.beta, reel.density.xi)
    np.testing.assert_array_equal(reel.density.f[0], start)
    np.testing.assert_allclose(start.sum(axis=1) * np.diff(reel.density.xi)[0], run.h[0], rtol=0.1)
    np.testing.assert_array_equal(reel.twin[0], closed.h)
    pictures = Pictures(reel, 240)
    pictures[7]
    heights, velocities, phase, _ = pictures._canvas.figure.axes
    for axes, own, other in ((heights, run.h, closed.h), (velocities, run.u, closed.u)):
        np.testing.assert_array_equal(axes.lines[0].get_ydata(), own[7])
        np.testing.assert_array_equal(axes.lines[1].get_ydata(), other[7])
        low, high = axes.get_ylim()
        assert low <= own.min() < own.max() < high
    shown, (_, _, low, high) = phase.images[0].get_array(), phase.images[0].get_extent()
    mass = shown.sum(axis=0) * (high - low) / len(shown)  # what is seen is f: its integral over xi is h
    np.testing.assert_allclose(mass, run.h[7], rtol=0.02)


def test_the_nodes_that_a_force_moved_are_drawn_where_they_are(run):
    f = run.dumps["f"]
    moved = f.assign_coords(offset=(("t", "x"), np.full(f.shape[:2], 0.5)))
    pictures = Pictures(reel_of(replace(run, q=run.q + 0.5 * run.h, dumps={"f": moved}), 600), 240)
    pictures[-1]
    image = pictures._canvas.figure.axes[2].images[0]
    _, _, low, high = image.get_extent()
    shown = np.asarray(image.get_array())
    places = low + (np.arange(len(shown)) + 0.5) * (high - low) / len(shown)
    u = (shown * places[:, None]).sum(axis=0) / shown.sum(axis=0)
    np.testing.assert_allclose(u, run.u[-1] + 0.5, atol=0.05)


def test_m_stands_in_where_f_was_not_kept_along(run):
    sparse = replace(run, dumps={"f": run.dumps["f"][[0, -1]], "m": run.dumps["f"].assign_attrs(long_name="M")})
    assert reel_of(sparse, 9).density is None
    pictures = Pictures(reel_of(sparse, 9), 240)
    assert "equilibrium" in pictures._canvas.figure.axes[-1].get_ylabel()
    assert len(Pictures(reel_of(replace(run, method=METHOD.twin), 9), 240)._canvas.figure.axes) == 2


def test_a_stored_run_makes_the_same_film(tmp_path, run):
    run.to_netcdf(tmp_path / "run.nc")
    stored, fresh = read_reel(tmp_path / "run.nc", 5), reel_of(run, 5)
    assert (stored.title, stored.method, stored.scene.beta) == (fresh.title, fresh.method, SCENE.beta)
    for name in ("t", "h", "u"):
        np.testing.assert_array_equal(getattr(stored, name), getattr(fresh, name))
    np.testing.assert_array_equal(stored.density.f, fresh.density.f)


@pytest.mark.parametrize(
    ("method", "clock", "kept"),
    [
        ({"velocity": {"count": 16}}, {"number": 0.4, "end": 0.5}, True),
        ({"scheme": 4, "velocity": {"kind": "window", "dxi": 0.2}}, {"dt": 0.01, "steps": 30}, True),
        ({"scheme": 4, "velocity": {"kind": "fitted"}}, {"dt": 0.01, "steps": 30}, False),
        ({"kind": "macroscopic"}, {"number": 0.4, "end": 0.5}, False),
    ],
)
def test_a_scene_is_run_with_its_twin_at_the_same_times(method, clock, kept):
    keys = read_keys("silo") | {"method": method, "clock": clock}
    run, *twins = shoot(check(keys, "silo"), 10)
    reel = reel_of(run, 10, *twins)
    assert 5 <= reel.t.size <= 10
    assert reel.t[-1] == run.t[-1]
    assert (reel.density is not None) == kept
    assert len(twins) == (method.get("kind") != "macroscopic")
    for twin in twins:
        assert twin.method == run.method.twin
        assert np.isfinite(reel.twin[0]).all()
        np.testing.assert_allclose(reel.twin[0], reel.h, atol=0.2)
    assert Pictures(reel, 240)[0].shape[1] == 240


def test_the_command_makes_a_film_from_a_scene_and_from_a_run(folder):  # noqa: F811
    small = ("--frames", "2", "--width", "240")
    assert "film.gif: 2 frames of f, t = 0 to 0.02" in kinsim("animate", "small.toml", "-o", "film.gif", *small).output
    kinsim("run", "small.toml", "--out", "run.nc", "--quiet")
    assert "2 frames of M of h and u" in kinsim("animate", "run.nc", "-o", "run.html", *small).output
    words = ("animate", "small.toml", "--method", "macroscopic", "--quiet", "-o", "closed.gif", *small)
    assert kinsim(*words).output == ""
    words = ("animate", "small.toml", "--set", "method.velocity.bound=0.5", "-o", "stopped.gif", *small)
    assert "take a bound of" in kinsim(*words, code=1).stderr
    assert written(folder) == {"film.gif", "run.nc", "run.html", "closed.gif", "stopped.gif"}


@pytest.mark.parametrize(
    ("words", "wanted"),
    [
        (["small.toml", "-o", "film.png"], "film.png: is no film; end its name in .gif, .html, .mp4"),
        (["small.toml", "-o", "film.mp4"], "film.mp4: mp4 is made by ffmpeg, which is not found; install it, or take"),
        (["small.toml", "-o", "no/film.gif"], "no/film.gif: the folder no does not exist; create it first"),
        (
            ["small.toml", "-o", "film.gif", "--frames", "1"],
            "film: frames: should be greater than or equal to 2",
        ),
        (["small.toml", "-o", "film.gif", "--rate", "99"], "film: rate"),
        (["small.toml", "-o", "film.gif", "--width", "9"], "film: width"),
        (["small.toml", "-o", "film.gif", "--set", "clock.dt=0.5"], "dt = 0.5 breaks the CFL bound (28)"),
        (["sillo", "-o", "film.gif"], "sillo: no such scene; did you mean silo?"),
        (["run.nc", "-o", "film.gif"], "run.nc: there is no such file; make it with kinsim run NAME --out run.nc"),
        (["text.nc", "-o", "film.gif"], "text.nc: is no netCDF file, or a broken one"),
        (["study.nc", "-o", "film.gif"], "study.nc: holds no run; make one with kinsim run NAME --out study.nc"),
        (["study.nc", "-o", "film.gif", "--set", "clock.steps=1"], "study.nc: has been run; --method, --set"),
    ],
)
def test_bad_requests_leave_one_line_and_nothing_else(folder, words, wanted, monkeypatch):  # noqa: F811
    import xarray

    monkeypatch.setenv("PATH", str(folder))
    (folder / "text.nc").write_text("no run")
    xarray.Dataset({"h": ("t", [1.0])}).to_netcdf("study.nc", engine="h5netcdf")
    result = kinsim("animate", *words, code=2)
    assert result.stderr.startswith(wanted) or wanted in result.stderr
    assert result.stderr.count("\n") == 1
    assert written(folder) == {"text.nc", "study.nc"}


@pytest.mark.parametrize("fails", [False, True])
def test_an_mp4_gets_its_frames_through_ffmpeg(tmp_path, run, monkeypatch, fails):
    """A stand-in for ffmpeg keeps what it was given, or dies of it."""
    tool = tmp_path / "ffmpeg"
    does = "echo no such codec >&2; exit 3" if fails else 'for name; do :; done; cat >"$name"'
    tool.write_text(f"#!/bin/sh\n{does}\n")
    tool.chmod(tool.stat().st_mode | stat.S_IXUSR)
    monkeypatch.setenv("PATH", str(tmp_path), prepend=os.pathsep)
    if fails:
        with pytest.raises(InputError, match="ffmpeg could not make the film: no such codec"):
            animate(run, tmp_path / "film.mp4", **SMALL)
        assert written(tmp_path) == {"ffmpeg"}
    else:
        frames = Pictures(reel_of(run, 5), 240)
        film = animate(run, tmp_path / "film.mp4", **SMALL).read_bytes()
        assert film == b"".join(frame.tobytes() for frame in frames)
