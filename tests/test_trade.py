"""Cost against error: errors that other code finds as well, a front that brute force finds as well."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray
from typer.testing import CliRunner

from kinsim import (
    Choice,
    Courant,
    Fitted,
    Fixed,
    InputError,
    Kinetic,
    Macroscopic,
    Uniform,
    exact,
    load_scene,
    simulate,
    trade,
)  # fmt: skip
from kinsim.cli import app
from kinsim.plot.trade import draw_trade
from kinsim.studies import engine, record
from kinsim.studies.member import Member
from kinsim.trades.family import lines
from kinsim.trades.front import knee, pareto

RIEMANN, _, _ = load_scene("riemann")
RIEMANN = replace(RIEMANN, cells=replace(RIEMANN.cells, count=48))
FAMILY = [
    Choice("closed form", Macroscopic()),
    Choice("fitted", Kinetic(velocity=Fitted(2))),
    Choice("cell average", Kinetic(velocity=Uniform(16))),
    Choice("dx", Macroscopic(), 0.5),
    Choice("broken", Macroscopic(), number=1.5),
]


def test_errors_are_those_to_the_twin_and_to_the_exact_solution() -> None:
    found = trade(RIEMANN, Kinetic(), Courant(0.9, 2.0), family=FAMILY, repeats=3)
    assert found["verdict_kind"].values.tolist() == ["finished"] * 4 + ["refused"]
    assert "breaks the CFL bound" in found["verdict"].values[4]
    assert np.isnan(found["total_error"].values[4])
    steps = int(found["steps"][0])
    clock = Fixed(2.0 / steps, steps)
    judge = exact.Riemann(1, 0, 0.5, 0, RIEMANN.beta).averages(RIEMANN.cells, 2.0)[0]
    mass = RIEMANN.initial()[0].sum()
    twin = simulate(RIEMANN, Macroscopic(), clock).h[-1]
    for at in range(3):
        h = simulate(RIEMANN, FAMILY[at].method, clock).h[-1]
        one = found.isel(member=at)
        assert float(one["velocity_error"]) == pytest.approx(np.abs(h - twin).sum() / mass, rel=1e-9)
        assert float(one["total_error"]) == pytest.approx(np.abs(h - judge).sum() / mass, rel=1e-9)
    assert (found["wall_time_low"] <= found["wall_time"])[:4].all()
    assert (found["wall_time"] <= found["wall_time_high"])[:4].all()
    assert float(found["ns_per_cell_step"][0]) == pytest.approx(1e9 * float(found["wall_time"][0]) / (48 * steps))
    assert (found["memory"][:4] > 48 * 8).all()


def test_without_an_exact_solution_a_fine_reference_judges_and_rest_is_measured() -> None:
    scene, _, _ = load_scene("parabola")
    scene = replace(scene, cells=replace(scene.cells, count=40))
    family = [Choice("closed form", Macroscopic(), cells) for cells in (0.5, 1.0, 2.0)]
    family.append(Choice("fitted", Kinetic(velocity=Fitted(1))))
    found = trade(scene, Kinetic(), Courant(0.9, 6.0), family=family, repeats=1)
    assert found.attrs["judge"] == "second order on 320 cells"
    assert 0.0 < found.attrs["judge_error"] < float(found["total_error"][2])
    assert (np.diff(found["total_error"].values[:3]) < 0).all()
    assert (found["rest_residual"][:3] == 0.0).all()
    fine = simulate(replace(scene, cells=replace(scene.cells, count=1280)), Macroscopic(order=2), Courant(0.4, 6.0))
    off = simulate(scene, Macroscopic(), Courant(0.8, 6.0)).h[-1] - fine.h[-1].reshape(40, -1).mean(axis=1)
    total = np.abs(off).sum() / scene.initial()[0].sum()
    assert float(found["total_error"][1]) == pytest.approx(total, rel=0.1)


def test_the_front_is_what_brute_force_finds(rng: np.random.Generator) -> None:
    cost, error = 10.0 ** rng.uniform(-2, 0, (2, 60))
    error[::9] = np.nan
    cost[1::9] = np.nan
    good = np.isfinite(cost) & np.isfinite(error)
    wanted = [
        i for i in np.flatnonzero(good)
        if not any(cost[j] <= cost[i] and 0.99 * error[j] <= error[i] for j in np.flatnonzero(good) if j != i)
    ]  # fmt: skip
    front = pareto(cost, error)
    assert set(wanted) <= set(front)
    assert (np.diff(cost[front]) > 0).all()
    assert (error[front][1:] < 0.99 * error[front][:-1]).all()


def test_the_knee_is_the_corner() -> None:
    cost, error = np.array([1.0, 2.0, 4.0, 8.0, 16.0]), np.array([1.0, 0.1, 0.01, 0.009, 0.008])
    assert knee(cost, error, pareto(cost, error)) == 2
    assert knee(cost[:2], error[:2], [0, 1]) is None


def test_a_picture_without_velocity_errors_says_so() -> None:
    silo, _, _ = load_scene("silo")
    scene, clock = replace(silo, cells=replace(silo.cells, count=24)), Fixed(1e-4, 2)
    twins = [Choice("sampled", Macroscopic()), Choice("closed form", Macroscopic())]
    for family in (twins, twins[:1]):
        _, nodes = draw_trade(trade(scene, Kinetic(), clock, family=family, repeats=1)).axes
        assert "no velocity errors" in [text.get_text() for text in nodes.texts]
    one = trade(RIEMANN, Kinetic(), Courant(0.9, 0.2), family=FAMILY[:3], repeats=1)
    words = draw_trade(one).axes[1].get_legend_handles_labels()[1]
    assert "fitted nodes" in words  # of one number of nodes no order is told
    assert not any("geometric" in told for told in words)


def test_lines_hold_what_the_scheme_can() -> None:
    assert {choice.method.order for choice in lines(Kinetic())["order"]} == {2}
    assert "order" not in lines(Kinetic(scheme=2))
    assert {choice.method.scheme for line in lines(Macroscopic(1)).values() for choice in line} == {1}


@pytest.mark.parametrize(
    ("options", "line"),
    [
        ({"family": []}, "the family is empty"),
        ({"family": [Kinetic()]}, r"family\[0\] is a Kinetic; give kinsim.trades.family.Choice"),
        ({"lines": []}, "the family is empty"),
        ({"lines": ["fited"]}, "no line 'fited'; choose from closed form"),
        ({"family": FAMILY, "repeats": 0}, "repeats = 0"),
    ],
)
def test_bad_families_get_one_line(options: dict[str, object], line: str) -> None:
    with pytest.raises(InputError, match=line):
        trade(RIEMANN, Kinetic(), Courant(0.9, 0.2), **options)


def test_the_command_writes_three_files_and_resumes(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["trade", "riemann", "--set", "cells.count=24", "--set", "method.scheme=4", "--line", "cell average",
             "--line", "closed form", "--repeats", "2"]  # fmt: skip
    done = CliRunner().invoke(app, words, env={"COLUMNS": "200"})
    assert done.exit_code == 0, done.output
    assert "judged by the exact solution" in done.stdout
    assert Path("trade.png").read_bytes().startswith(b"\x89PNG")
    assert len(Path("trade.csv").read_text().splitlines()) == 8
    with xarray.open_dataset("trade.nc", engine="h5netcdf") as kept:
        assert kept["line"].values.tolist() == ["cell average"] * 6 + ["closed form"]

    def never(member: Member, progress: object = None) -> record.Record:
        raise AssertionError(member)

    monkeypatch.setattr(engine, "perform", never)
    before = Path("trade.csv").read_text()
    assert CliRunner().invoke(app, [*words, "--resume"]).exit_code == 0
    assert Path("trade.csv").read_text() == before
