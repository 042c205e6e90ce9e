"""The lab without its page: it runs what simulate runs, shows what step shows, and saves what it shows."""

from __future__ import annotations

import itertools
import math
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from conftest import EPS, random_states
from scipy.integrate import quad
from test_cli import kinsim

from kinsim import ConstantSlope, InputError, Kinetic, load_scene, printed, simulate, step
from kinsim.diagnostics.causes import STAGES as CAUSES
from kinsim.kinetic.equilibrium import fill, weights
from kinsim.kinetic.force import FORCES
from kinsim.kinetic.velocity import Grid
from kinsim.lab.books import TOLD, Ledger
from kinsim.lab.cut import cut_at, error_bound, faces_of
from kinsim.lab.knobs import Slider, knobs_of
from kinsim.lab.picture import image_of
from kinsim.lab.play import STAGES, Play
from kinsim.lab.prepare import make
from kinsim.lab.setup import Setup
from kinsim.lab.told import PUSHED, passing, told
from kinsim.macroscopic.closed_form import half_moments_closed
from kinsim.read import built_in

SMALL = (("cells.count", 60), ("method.velocity.count", 32))

METHODS = {
    "scheme 1": (("method.scheme", 1),),
    "scheme 2": (("method.scheme", 2),),
    "scheme 3": (),
    "scheme 3, faces": (("method.coupling", "face"),),
    "scheme 4": (("method.scheme", 4),),
    "scheme 4, order 2": (("method.scheme", 4), ("method.order", 2)),
    "exact shift": (("method.force", "shift-exact"),),
    "matched": (("method.equilibrium", "matched"),),
}
REFUSED = ("clock.number", "method.velocity.count", "boundary", "method.order")
"""Knobs whose ends may not go with the rest of a scene."""

FIRST_TWO = ("upwind", "balanced")

SMOOTH = "scheme 4 on a smooth chute"


def setup_of(scene: str, *turns: tuple[str, object]) -> Setup:
    setup = Setup.of_scene(scene)
    for key, given in turns:
        setup = setup.turned(key, given)
    return setup


@pytest.fixture(scope="module", params=[*METHODS, SMOOTH])
def played(request):
    """A run of twelve steps in the lab, and its setup."""
    scene = "bend" if request.param == SMOOTH else "silo-incline"
    setup = setup_of(scene, *SMALL, *METHODS.get(request.param, METHODS["scheme 4"]))
    play = make(setup.file)
    for _ in range(12):
        assert play.advance()
    return setup, play


def test_it_takes_the_steps_of_a_run(played):
    setup, play = played
    file = setup.file
    run = simulate(file.scene, file.method, file.clock, save_every=1)
    np.testing.assert_array_equal(play.solver.h, run.h[12])
    np.testing.assert_array_equal(play.solver.q, run.q[12])
    assert play.solver.t == run.t[12]
    twin = simulate(file.scene, file.method.twin, run.replay, save_every=1)
    np.testing.assert_array_equal(play.twin.h, twin.h[12])
    np.testing.assert_array_equal(play.twin.q, twin.q[12])


def test_each_stage_is_that_of_a_step(played):
    setup, play = played
    before = Play(setup.file)
    for _ in range(11):
        before.advance()
    h, q = before.solver.h.copy(), before.solver.q.copy()
    shown = step(play.scene, play.method, h, q, play.stages.dt)
    for stage, f, momentum in (("transport", shown.f_transport, shown.qhat), ("force", shown.f_force, shown.q1)):
        play.stage = stage
        moment = play.moment()
        np.testing.assert_array_equal(moment.f, f)
        np.testing.assert_array_equal(moment.h, shown.h1)
        np.testing.assert_allclose(moment.h * np.nan_to_num(moment.u), momentum, rtol=4 * EPS, atol=1e-300)
        np.testing.assert_array_equal(moment.face_h, h)
    play.stage = "projection"
    first = replace(play.method, order=1)  # order 2 begins with two halves of a cell
    np.testing.assert_array_equal(play.moment().f, step(play.scene, first, shown.h1, shown.q1, 1e-3).M)
    play.stage = "force"


def test_the_ledger_adds_up_and_is_the_one_of_a_run(played):
    setup, play = played
    books = Ledger(play).books()
    if setup.file.method.order == 2 or not isinstance(setup.file.chute, ConstantSlope):
        assert not books.causes
        return
    assert np.abs(books.unexplained).max() <= 64 * EPS * np.abs(books.now).max() * len(CAUSES)
    run = simulate(setup.file.scene, setup.file.method, setup.file.clock, save_every=12, causes=True)
    booked = run.causes["sum"].sel(t=run.t[1], quantity=["mass", "momentum", "entropy"])
    for cause, name in TOLD.items():
        np.testing.assert_array_equal(books.causes[name], booked.sel(stage=cause))


def test_three_stages_are_a_step():
    play = Play(setup_of("silo", *SMALL).file)
    assert play.moment().stage == "projection"
    seen = []
    for _ in range(7):
        assert play.next_stage()
        seen.append((play.step, play.moment().stage))
    assert seen == [(1 + k // 3, STAGES[k % 3]) for k in range(7)]


def test_a_run_that_is_over_says_how():
    play = Play(setup_of("riemann", *SMALL, ("clock.end", 0.5)).file)
    while play.advance():
        pass
    assert play.verdict.kind == "finished"
    assert play.solver.t == 0.5
    assert not play.next_stage()
    assert play.moment().stage == "projection"
    np.testing.assert_allclose(play.moment().exact_h, play.exact(play.scene.x, 0.5)[0])


def test_moments_of_the_cut_keep_their_bound_and_match_quadrature():
    """Closed forms against quadrature; sums over the shaded cells within what is proved; misprints as in the paper."""
    setup = setup_of("riemann", *SMALL, ("heap.velocities.0", 0.6), ("heap.velocities.1", -0.2))
    play = make(setup.file)
    for _ in range(9):
        play.advance()
    moment = play.moment()
    worst = 0.0
    for cell in range(0, 60, 7):
        for states in ("upwind", "balanced"):
            for half in cut_at(play, moment, cell, states).halves:
                assert abs(half.summed - half.closed) <= half.bound
                worst = max(worst, abs(half.summed - half.closed) / half.bound)
    assert worst > 0.02  # a bound that is never approached would say nothing
    cut = cut_at(play, moment, 30)
    h, u = moment.face_h[30:32], moment.face_u[30:32]
    for k, half in enumerate(cut.halves):
        side, power = k % 2, 1 + k // 2
        c = math.sqrt(2 * play.scene.beta * h[side])
        low, high = u[side] - c, u[side] + c
        ends = (max(low, 0.0), max(high, 0.0)) if side == 0 else (min(low, 0.0), min(high, 0.0))
        found, _ = quad(
            lambda xi, power=power, side=side, c=c: xi**power * math.sqrt(max(c * c - (xi - u[side]) ** 2, 0.0)),
            *ends, epsabs=1e-13, limit=200,
        )  # fmt: skip
        assert half.closed == pytest.approx(found / (math.pi * play.scene.beta), abs=1e-10)
    assert [half.misprinted for half in cut.halves] == [False, False, True, False]
    assert cut.halves[2].printed == printed.I3(float(h[0]), float(u[0]), play.scene.beta)
    balanced = cut_at(play, moment, 30, "balanced").halves
    assert [half.misprinted for half in balanced] == [True, True, False, False]
    assert [half.name for half in balanced] == ["Ĩ1", "Ĩ2", "Ĩ3", "Ĩ4"]


@pytest.mark.parametrize("second", [False, True])
def test_the_bound_of_a_shaded_sum_holds_and_is_near(rng, second):
    """Sums over the averages of M in velocity cells that begin at 0, against the closed form, for many states."""
    beta, dxi = 0.4, 0.05
    grid = Grid(400, dxi)
    weighed = weights("cell-average", grid)[second]
    h, u = random_states(rng, 200)
    rows = fill("cell-average", h, u, h, u, beta, grid)
    share = []
    for row, h_one, u_one in zip(rows, h, u, strict=True):
        closed = half_moments_closed(h_one, u_one, beta)[second]
        share.append(abs(row[grid.half :] @ weighed - closed) / error_bound(second, h_one, u_one, beta, dxi))
    assert 0.02 < max(share) <= 1.0


@pytest.mark.parametrize("scene", ["silo-incline", "bend"])
@pytest.mark.parametrize("stage", STAGES)
def test_what_is_shaded_at_a_held_face_is_what_the_scheme_sums_up(scene, stage):
    """The half-ranges of scheme 4, held or not, add up to the flux of a step from the state that is looked at."""
    setup = setup_of(scene, *SMALL, ("method.scheme", 4), ("method.statics", "hold"))
    play = make(setup.file)
    for _ in range(12):
        play.advance()
    play.stage = stage
    moment = play.moment()
    shown = step(play.scene, play.method, moment.face_h, moment.face_h * moment.face_u, play.stages.dt)
    apart = 0
    for cell in range(59):
        cut = cut_at(play, moment, cell, "held")
        sums = [half.summed for half in cut.halves]
        still = shown.states.h_left[cell + 1] == shown.states.h_right[cell + 1] and moment.face_u[cell] == 0.0
        near = sum(half.bound for half in cut.halves) if still else 1e-13  # still faces have their pressure exactly
        assert sums[0] + sums[1] == pytest.approx(shown.flux[0, cell + 1], abs=1e-13)
        assert sums[2] + sums[3] == pytest.approx(shown.flux[1, cell + 1], abs=near)
        for half in cut.halves:
            assert abs(half.summed - half.closed) <= half.bound
        apart += [half.closed for half in cut.halves] != [half.closed for half in cut_at(play, moment, cell).halves]
    assert apart > 0


def test_the_faces_that_a_scheme_sums_up_come_first():
    first = {1: "upwind", 2: "balanced", 3: "upwind", 4: "held"}
    for scheme, states in first.items():
        assert faces_of(Kinetic(scheme=scheme))[0] == states
    assert faces_of(Kinetic(scheme=4, order=2)) == faces_of(Kinetic(scheme=4, statics="reflect")) == FIRST_TWO


@pytest.mark.parametrize("coupling", ["cell", "face"])
def test_the_lab_says_which_face_a_cell_of_scheme_3_took(coupling):
    play = make(setup_of("silo-incline", *SMALL, ("method.coupling", coupling)).file)
    assert "a step tells" in passing(play, play.moment(), 20)
    for _ in range(5):
        play.advance()
    before, moment = play.stages, play.moment()
    shown = step(play.scene, play.method, before["h"], before["q"], before.dt)
    for cell in range(59):
        slow = shown.slow[cell : cell + 2].all() if coupling == "face" else shown.slow[cell]
        assert ("balanced" in passing(play, moment, cell)) == slow
    assert 0 < shown.slow.sum() < 60


def test_other_schemes_say_what_they_sum_up_where_no_choice_of_faces_does():
    for turns, word in (
        ((("method.scheme", 1),), ""), ((("method.scheme", 2),), ""), (METHODS["scheme 4"], ""),
        (METHODS["scheme 4, order 2"], "slopes"), ((*METHODS["scheme 4"], ("method.statics", "reflect")), "turns"),
    ):  # fmt: skip
        play = Play(setup_of("silo", *SMALL, *turns).file)
        assert word in passing(play, play.moment(), 20)
        assert bool(word) == bool(passing(play, play.moment(), 20))


def test_each_stage_and_each_force_has_its_sentence():
    assert set(PUSHED) == set(FORCES)
    play = Play(setup_of("riemann", *SMALL, ("method.scheme", 4)).file)
    assert "Start" in told(play.moment(), play.method, True)
    play.advance()
    play.stage = "force"
    assert "(23)" in told(play.moment(), play.method, True)
    assert "(18)" in told(play.moment(), replace(play.method, force="derivative-upwind"), True)
    assert "nothing does" in told(play.moment(), play.method, play.scene.forced)


def test_the_last_cell_shows_the_wall_on_its_left():
    play = Play(setup_of("silo", *SMALL).file)
    cut = cut_at(play, play.moment(), 59)
    assert cut.cell == 59
    assert cut.face_x == pytest.approx(play.scene.cells.right - play.scene.cells.dx)


def test_rows_whose_nodes_moved_are_drawn_where_they_are():
    play = make(setup_of("silo", *SMALL, ("method.force", "shift-exact")).file)
    play.advance()
    moment, grid = play.moment(), play.density.grid
    cells = np.arange(moment.h.size) % 7 - 3  # velocity cells up and down, and a bit
    image = image_of(replace(moment, offset=(cells + 0.3) * grid.dxi), grid)
    for row, moved in enumerate(cells):
        expected = np.roll(moment.f[row].astype(np.float32), moved)
        expected[: max(moved, 0)] = 0.0
        expected[expected.size + min(moved, 0) :] = 0.0
        np.testing.assert_array_equal(image[:, row], expected)
    np.testing.assert_array_equal(image_of(replace(moment, offset=0.0 * cells), grid), moment.f.T.astype(np.float32))


@pytest.mark.parametrize("scene", [*built_in()])
def test_every_knob_gives_a_run_or_a_sentence(scene):
    start = setup_of(scene)
    constant = isinstance(start.file.chute, ConstantSlope)
    refused = REFUSED if constant else (*REFUSED, "method.scheme")  # schemes 1 to 3 are those of a constant slope
    for knobs in knobs_of(start.file).values():
        for knob in knobs:
            given = start.given(knob.key)
            if isinstance(knob, Slider):
                assert knob.given(knob.shown(given)) == pytest.approx(given)
                tried = [knob.given(at) for at in (knob.low, 0.5 * (knob.low + knob.high), knob.high)]
            else:
                assert given in knob.options.values()
                tried = list(knob.options.values())
            for value in tried:
                turned = start.turned(knob.key, value)
                assert turned.refusal or turned.given(knob.key) == pytest.approx(value)
                assert "\n" not in turned.refusal
                assert not turned.refusal or knob.key in refused


@pytest.mark.parametrize(("scene", "method"), [*zip(itertools.cycle(built_in()), [*METHODS] * 2, strict=False)])
def test_a_saved_scene_is_the_same_scene(scene, method, tmp_path):
    """Each scene, and each method twice."""
    slope = [("chute.zeta", 0.1)] if isinstance(Setup.of_scene(scene).file.chute, ConstantSlope) else []
    setup = setup_of(scene, *METHODS[method], *slope, ("friction.delta", 0.3), ("epsilon", 0.31))
    path = tmp_path / "saved.toml"
    path.write_text(setup.toml(), encoding="utf-8")
    assert Setup.of_content(path.read_bytes(), "saved.toml").file == setup.file
    assert load_scene(path) == (setup.file.scene, setup.file.method, setup.file.clock)


def test_what_does_not_go_together_gets_a_sentence():
    order = setup_of("silo", ("method.scheme", 4), ("method.order", 2))
    assert not order.turned("method.force", "shift-exact").refusal
    assert order.turned("clock.number", 1.2).refusal == (
        "Courant number 1.2 is above 1, the CFL bound (28); take at most 1"
    )
    assert not order.turned("clock.number", 1.2).turned("clock.number", 1.0).refusal
    refused = order.turned("method.velocity.count", 1)
    assert refused.refusal
    assert not refused.turned("method.velocity.count", 32).refusal
    with pytest.raises(InputError, match="is not TOML"):
        Setup.of_content(b"no toml", "x.toml")
    with pytest.raises(InputError, match="did you mean silo"):
        Setup.of_scene("sillo")


def test_other_schemes_forget_what_they_do_not_read():
    setup = setup_of("silo", ("method.coupling", "face"))
    assert setup.turned("method.scheme", 4).file.method.coupling == "cell"
    order = setup_of("silo", ("method.scheme", 4), ("method.order", 2))
    assert order.turned("method.scheme", 1).file.method.order == 1


def test_methods_without_fixed_nodes_get_some_and_say_so():
    for given in ('kind = "macroscopic"\nscheme = 4', 'velocity = {kind = "fitted", count = 6}\nscheme = 4'):
        toml = setup_of("silo").toml().partition("[method]")[0]
        content = f"{toml}[method]\n{given}\n[clock]\ndt = 0.01\nsteps = 9"
        setup = Setup.of_content(content.encode(), "x")
        assert setup.file.method.velocity.count == 128
        assert setup.file.method.scheme == 4
        assert "128" in setup.notes[0]
        assert setup.given("clock.end") == pytest.approx(0.09)
        assert setup.turned("clock.number", 0.3).file.clock.end == pytest.approx(0.09)


WITHOUT = """
import sys
for name in ("panel", "bokeh", "tomli_w", "playwright"):
    sys.modules[name] = None
import kinsim.lab.books, kinsim.lab.cut, kinsim.lab.knobs, kinsim.lab.picture, kinsim.lab.play, kinsim.lab.prepare
import kinsim.lab.setup, kinsim.lab.serve, kinsim.lab.command
from kinsim.cli import app
app(["lab"])
"""


def test_without_the_extra_all_but_the_page_is_there():
    """The remedy in a line; the model of the lab loads, and needs nothing of the extra."""
    found = subprocess.run([sys.executable, "-c", WITHOUT], capture_output=True, text=True, check=False)
    assert found.returncode == 2
    assert found.stderr == "lab: Panel and Bokeh are not installed; run: pip install 'kinsim[lab]'\n"


def test_bad_requests_are_told_in_a_line(tmp_path):
    assert "no such scene" in kinsim("lab", "nowhere", code=2).stderr
    assert "leave out --port" in kinsim("lab", "silo", "--port", "99999", code=2).stderr
    fast = tmp_path / "fast.toml"
    fast.write_text(setup_of("silo", ("clock.number", 1.1)).toml(), encoding="utf-8")
    assert "take at most 1" in kinsim("lab", str(fast), code=2).stderr


@pytest.mark.filterwarnings("ignore:Widget.name:PendingDeprecationWarning")  # its new name came after Panel 1.5
def test_what_a_widget_of_a_scene_before_says_late_turns_nothing():
    """Its key may be none of the scene that came after, and its value is not meant for it."""
    from kinsim.lab.view.controls import Controls

    turned = []
    controls = Controls(lambda key, given: turned.append((key, given)))
    controls.fit(Setup.of_scene("silo"))
    _, before = controls._widgets["heap.heights.1"]
    before.value = before.end
    assert len(turned) == 1
    controls.fit(Setup.of_scene("sine"))
    before.value = before.start
    assert len(turned) == 1
