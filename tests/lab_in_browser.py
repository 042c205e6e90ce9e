"""`kinsim lab` in a real Chromium: run by `.ci/browser.py`, not with the other tests, since a machine may have none.

What the page shows is read from the browser, and judged by `kinsim.step`, `simulate` and quadrature.
"""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from contextlib import contextmanager

import numpy as np
import pytest
from playwright.sync_api import expect

from kinsim import load_scene, simulate, step
from kinsim.lab.play import Play
from kinsim.lab.setup import Setup
from kinsim.lab.view.painter import Painter
from kinsim.lab.view.widgets import PAUSE, Widgets

FIRST = 240_000
"""Milliseconds for what may have to compile kernels."""

expect.set_options(timeout=30_000)

PICTURE = """() => {
  const models = Bokeh.documents.flatMap(doc => [...doc._all_models.values()])
  const found = models.find(model => model.name == "picture of f")
  const image = found.data.image[0]
  return {shape: image.shape, values: Array.from(image)}
}"""


SLOW = """
import sys, time
from kinsim.lab import prepare
from kinsim.__main__ import main
make, seconds = prepare.make, float(sys.argv.pop())
prepare.make = lambda file: (time.sleep(seconds), make(file))[1]
sys.argv[1:] = ["lab", "silo", "--no-browser"]
main()
"""
"""The same, as on a machine where kernels have to be compiled first, for so many seconds."""


@contextmanager
def serving(*words: str):
    """The address of a command that is ended as a user ends it."""
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as running:
        try:
            line = running.stdout.readline()
            yield re.search(r"http://127\.0\.0\.1:\d+/", line)[0]
        finally:
            running.send_signal(signal.SIGINT)
            out, err = running.communicate(timeout=60)
    assert (running.returncode, out, err) == (0, "kinsim lab: ended\n", "")


@pytest.fixture(scope="session")
def server():
    """The command as a user types it."""
    with serving(sys.executable, "-m", "kinsim", "lab", "silo", "--no-browser") as address:
        yield address


@pytest.fixture(scope="session")
def open_page(server, chromium):
    """Opens pages of the lab; in the end none of them has complained, or asked anybody else for anything."""
    troubles, pages = [], []

    def asked(request):
        if not request.url.startswith((server, "blob:", "data:")):
            troubles.append(f"asked for {request.url}")

    def opened(width: int = 1400, height: int = 900):
        page = chromium.new_page(viewport={"width": width, "height": height}, accept_downloads=True)
        page.on("console", lambda said: troubles.append(said.text) if said.type in ("error", "warning") else None)
        page.on("pageerror", lambda error: troubles.append(str(error)))
        page.on("request", asked)
        page.on("response", lambda got: troubles.append(f"{got.status} {got.url}") if got.status >= 400 else None)
        page.goto(server)
        expect(page.locator(".now")).to_contain_text("step 0", timeout=FIRST)
        pages.append(page)
        return page

    yield opened
    for page in pages:
        page.close()
    assert troubles == []


@pytest.fixture(scope="session")
def first(open_page):
    return open_page()


@pytest.fixture
def page(first):
    """The page as it comes, at its start."""
    first.locator(".scene select").select_option("silo")
    press(first, "reset")
    first.locator(".stage button").nth(1).click()
    expect(first.locator(".now")).to_contain_text("step 0")
    expect(first.locator(".knob-clock-number")).to_contain_text("0.450")
    np.testing.assert_array_equal(settled(first), start_of("silo"))
    return first


def start_of(scene: str) -> np.ndarray:
    """M of the initial state of a scene on the nodes of the lab, as the page has it."""
    return Play(Setup.of_scene(scene).file).moment().f.T.astype(np.float32)


def settled(page) -> np.ndarray:
    """The picture once it stays: a new run is made aside."""
    for _ in range(60):
        before = picture(page)
        page.wait_for_timeout(400)
        if np.array_equal(after := picture(page), before):
            return after
    return after


def picture(page) -> np.ndarray:
    """f as the browser has it, shape (n, nx)."""
    got = page.evaluate(PICTURE)
    return np.array(got["values"]).reshape(got["shape"])


def press(page, name: str) -> None:
    page.locator(f".{name} button").first.click()


def steps(page) -> int:
    return int(re.search(r"step (\d+)", page.locator(".now").inner_text())[1])


def moments(page) -> dict[str, list[str]]:
    """The rows of the table, by the name of the moment."""
    rows = page.locator("tr[data-moment]").all()
    return {row.get_attribute("data-moment"): [cell.inner_text() for cell in row.locator("td").all()] for row in rows}


def number(text: str) -> float:
    return float(text.replace("\N{MINUS SIGN}", "-").split()[0])


def turn(page, knob: str, key: str, times: int = 1) -> None:
    """Move a slider by its keyboard."""
    handle = page.locator(f".knob-{knob} .noUi-handle").first
    handle.focus()
    for _ in range(times):
        handle.press(key)


def test_stages_are_those_of_a_step(page):
    file = Setup.of_scene("silo").file
    play = Play(file)
    play.advance()
    h, q = file.scene.initial()
    stages = step(file.scene, play.method, h, q, float(play.simulation.dts[0][0]))
    np.testing.assert_array_equal(picture(page), stages.M.T.astype(np.float32))
    after = step(file.scene, play.method, stages.h1, stages.q1, float(play.simulation.dts[0][0]))
    for words, f in (("Transport", stages.f_transport), ("Force", stages.f_force), ("Projection", after.M)):
        press(page, "next")
        expect(page.locator(".stage-told")).to_contain_text(words)
        np.testing.assert_array_equal(picture(page), f.T.astype(np.float32))
        assert steps(page) == 1
    press(page, "next")
    expect(page.locator(".now")).to_contain_text("step 2")


def test_it_plays_and_pauses_and_another_tab_does_not(page, open_page):
    other = open_page(1000, 700)
    before = page.locator(".bk-Canvas, canvas").first.screenshot()
    press(page, "play")
    expect(page.locator(".play button")).to_contain_text(PAUSE)
    expect(page.locator(".now")).to_contain_text("pictures/s")
    press(page, "play")
    expect(page.locator(".play button")).not_to_contain_text(PAUSE)
    page.wait_for_timeout(300)
    seen = steps(page)
    assert seen >= 5
    page.wait_for_timeout(300)
    assert steps(page) == seen
    assert steps(other) == 0
    assert page.locator(".bk-Canvas, canvas").first.screenshot() != before
    file = Setup.of_scene("silo").file
    run = simulate(file.scene, file.method, file.clock, save_every=1)
    f = step(file.scene, Play(file).method, run.h[seen - 1], run.q[seen - 1], run.dt[seen - 1]).f_force
    np.testing.assert_array_equal(picture(page), f.T.astype(np.float32))


def test_shaded_moments_keep_their_bound_and_misprints_show(page):
    for _ in range(3):
        press(page, "one")
    expect(page.locator(".now")).to_contain_text("step 3")
    page.locator(".printed input").check()
    expect(page.locator(".moments th").last).to_have_text("as printed")
    rows = moments(page)
    assert list(rows) == ["I1", "I2", "I3", "I4"]
    for cells in rows.values():
        summed, closed, difference, bound = (number(cell) for cell in cells[2:6])
        assert abs(difference) <= bound
        assert summed - closed == pytest.approx(difference, abs=1.1e-6 + 0.06 * abs(difference))
        assert closed != 0.0
    assert "✗" in rows["I3"][6]
    assert all("✓" in rows[name][6] for name in ("I1", "I2", "I4"))
    page.locator(".faces select").select_option(label="balanced face (25)")
    expect(page.locator("tr[data-moment='Ĩ1']")).to_be_visible()
    assert "✗" in moments(page)["Ĩ1"][6]


def test_a_slider_changes_the_picture_and_a_saved_scene_brings_it_back(page, open_page, tmp_path):
    start = picture(page)
    turn(page, "heap-heights-1", "ArrowRight", 3)
    turn(page, "epsilon", "ArrowLeft", 2)
    expect(page.locator(".knob-heap-heights-1")).to_contain_text("2.450")
    changed = settled(page)
    assert changed.shape == start.shape
    assert np.abs(changed - start).max() > 0.01
    with page.expect_download() as download:
        page.locator(".save a, .save button").first.click()
    path = tmp_path / "saved.toml"
    download.value.save_as(path)
    scene, method, clock = load_scene(path)
    assert scene.heap.heights == (0.3, 2.45, 0.3)
    assert scene.epsilon == 0.38
    run = simulate(scene, method, clock, save_every=1)
    for _ in range(2):
        press(page, "one")
    expect(page.locator(".now")).to_contain_text("step 2")
    shown = picture(page)
    other = open_page()
    other.locator(".load input").set_input_files(path)
    expect(other.locator(".knob-heap-heights-1")).to_contain_text("2.450")
    np.testing.assert_array_equal(settled(other), changed)
    for _ in range(2):
        press(other, "one")
    expect(other.locator(".now")).to_contain_text("step 2")
    np.testing.assert_array_equal(picture(other), shown)
    f = step(
        scene, Play(Setup.of_content(path.read_bytes(), "saved").file).method, run.h[1], run.q[1], run.dt[1]
    ).f_force
    np.testing.assert_array_equal(shown, f.T.astype(np.float32))


def test_wrong_settings_get_a_sentence(page, tmp_path):
    turn(page, "clock-number", "End")
    expect(page.locator(".told .fault")).to_have_text(
        "Courant number 1.2 is above 1, the CFL bound (28); take at most 1"
    )
    expect(page.locator(".play button")).to_be_disabled()
    turn(page, "clock-number", "Home")
    expect(page.locator(".told .fault")).to_have_count(0)
    expect(page.locator(".play button")).to_be_enabled()
    path = tmp_path / "wrong.toml"
    path.write_text("epsilon = ", encoding="utf-8")
    page.locator(".load input").set_input_files(path)
    expect(page.locator(".told .fault")).to_contain_text("wrong.toml: is not TOML")
    empty = tmp_path / "empty.toml"
    empty.touch()
    page.locator(".load input").set_input_files(empty)
    expect(page.locator(".told .fault")).to_contain_text("empty.toml: ")


def test_a_click_chooses_the_cell(page):
    before = page.locator(".cut-title h2").inner_text()
    chart = page.locator(".chart").first.bounding_box()
    page.mouse.click(chart["x"] + 0.7 * chart["width"], chart["y"] + 0.5 * chart["height"])
    expect(page.locator(".cut-title h2")).not_to_have_text(before)
    assert re.search(r"Cut at x = [1-7]", page.locator(".cut-title h2").inner_text())


def test_a_page_whose_run_is_still_being_made_says_so_and_keeps_what_it_is_asked(chromium):
    with serving(sys.executable, "-c", SLOW, "4") as address:
        page = chromium.new_page()
        page.goto(address)
        expect(page.locator(".told")).to_contain_text("Compiling the kernels of this method")
        assert page.locator(".now").count() == 0
        press(page, "one")
        expect(page.locator(".now")).to_contain_text("step 1")
        expect(page.locator(".told .say")).to_have_count(0)
        page.locator(".scene select").select_option("riemann")
        expect(page.locator(".told")).to_contain_text("Compiling the kernels of this method")
        press(page, "next")
        press(page, "next")
        assert steps(page) == 1  # of the run before, which is not stepped under the name of the new one
        expect(page.locator(".stage-told")).to_contain_text("2 Force")
        expect(page.locator(".told .say")).to_have_count(0)
        page.close()


def test_the_command_ends_while_kernels_compile(chromium):
    with serving(sys.executable, "-c", SLOW, "3600") as address:
        page = chromium.new_page()
        page.goto(address)
        expect(page.locator(".told")).to_contain_text("Compiling the kernels of this method")
        page.close()


def test_tabs_that_are_closed_while_they_play_are_no_event(chromium):
    with serving(sys.executable, "-m", "kinsim", "lab", "silo", "--no-browser") as address:
        for _ in range(4):
            page = chromium.new_page()
            page.goto(address)
            expect(page.locator(".now")).to_contain_text("step 0", timeout=FIRST)
            press(page, "play")
            expect(page.locator(".now")).to_contain_text("pictures/s")
            page.reload()
            expect(page.locator(".now")).to_contain_text("step 0")
            press(page, "play")
            expect(page.locator(".now")).to_contain_text("pictures/s")
            page.close()


def test_the_shaded_faces_are_those_that_the_scheme_sums_up(page):
    options = page.locator(".faces option")
    expect(options).to_have_text(["upwind face (19)", "balanced face (25)"])
    page.locator(".knob-method-scheme select").select_option(label="4  ours: conservative, at rest")
    expect(options).to_have_text(["held face of scheme 4", "upwind face (19)", "balanced face (25)"])
    page.wait_for_timeout(500)
    press(page, "one")
    expect(page.locator(".now")).to_contain_text("step 1")
    held = moments(page)
    page.locator(".faces select").select_option(label="upwind face (19)")
    expect(page.locator("tr[data-moment='I2']")).not_to_contain_text(held["I2"][2])
    for cells in held.values():
        difference, bound = (number(cell) for cell in cells[4:6])
        assert abs(difference) <= bound
    for scheme, first in (("2  balanced, stopping", "balanced face (25)"), ("3  both, coupled", "upwind face (19)")):
        page.locator(".knob-method-scheme select").select_option(label=scheme)
        expect(options.first).to_have_text(first)
        expect(page.locator(".faces select")).to_have_value(first)
    expect(page.locator(".passing")).to_contain_text("Slow cells take the balanced face")
    press(page, "one")
    expect(page.locator(".passing")).to_contain_text("In this step the cell took the")


def test_a_setting_that_cannot_be_made_is_not_played_as_another(page, tmp_path):
    path = tmp_path / "large.toml"
    path.write_text(Setup.of_scene("silo").turned("method.velocity.count", 10**8).toml(), encoding="utf-8")
    page.locator(".load input").set_input_files(path)
    expect(page.locator(".told .fault")).to_contain_text("bytes")
    for name in ("play", "one", "next"):
        expect(page.locator(f".{name} button")).to_be_disabled()
    page.locator(".scene select").select_option("silo")
    expect(page.locator(".play button")).to_be_enabled()
    expect(page.locator(".told .fault")).to_have_count(0)


@pytest.mark.filterwarnings("ignore::PendingDeprecationWarning")
def test_colours_and_axes_grow_with_what_they_show():
    """Two layers that collide are denser than both; an exact solution is faster than the run."""

    def drawn(setup: Setup, steps: int) -> tuple[Play, Painter]:
        play, painter = Play(setup.file), Painter(Widgets(["riemann"], "riemann", lambda: None))
        painter.begin(play)
        for _ in range(steps):
            play.advance()
            painter.show(play, "upwind", printed=False, words=True, rate=0.0)
        return play, painter

    riemann = Setup.of_scene("riemann").turned("cells.count", 60).turned("method.velocity.count", 32)
    play, painter = drawn(riemann.turned("heap.velocities.0", 3).turned("heap.velocities.1", -3), 20)
    play.stage = "projection"
    peak = play.moment().f.max()
    colours = painter.figures["density"].renderers[0].glyph.color_mapper
    assert peak > 0.9  # at the start 0.71
    assert peak <= colours.high < 2.0 * peak
    assert f"{colours.high:.2g}, <b>" in painter._widgets.texts["scale"].object
    play, painter = drawn(riemann.turned("method.scheme", 4).turned("heap.heights.1", 0), 40)
    assert np.nanmax(play.moment().exact_u) > 1.05 * np.nanmax(play.moment().u)
    assert painter.figures["velocity"].y_range.end >= np.nanmax(play.moment().exact_u)
