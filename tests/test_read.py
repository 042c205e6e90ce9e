"""Scene files: what the built-in ones say, and what is said about bad ones."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import SCENES

from kinsim import Courant, Fixed, InputError, Kinetic, Macroscopic, Table, Uniform, load_scene
from kinsim.read import built_in, change, check, read_keys, take_method

GOOD = """
title = "small"
epsilon = 0.4
k = 1.0
boundary = "open"
[cells]
left = -2
right = 2
count = 20
[chute]
kind = "constant"
zeta = 0.0
[friction]
kind = "coulomb"
delta = "pi/10"
[heap]
kind = "blocks"
edges = [-1, 1]
heights = [0.3, 2.3, 0.3]
[method]
kind = "kinetic"
scheme = 3
velocity = {kind = "uniform", count = 16}
[clock]
dt = 0.001
steps = 20
"""

BAD = {
    "unknown key at the top": ("k = 1.0", "kay = 1.0", "kay: unknown key; choose from"),
    "unknown key": ("delta =", "delt =", "friction.delt: unknown key; did you mean delta?"),
    "unknown key deep down": ("count = 16", "cuont = 16", "method.velocity.cuont: unknown key; did you mean count?"),
    "unknown kind": ('"coulomb"', '"coulom"', "friction: no kind 'coulom'; did you mean coulomb?"),
    "no kind": ('kind = "blocks"', "", "heap: its kind is missing; choose from blocks, parabola"),
    "no such end": ('"open"', '"opne"', "boundary: should be 'open', 'wall' or 'periodic', got 'opne'"),
    "mixed ends": ('"open"', '["open", "periodic"]', "boundary[1]: should be 'open' or 'wall', got 'periodic'"),
    "wrong type": ("epsilon = 0.4", "epsilon = true", "epsilon: should be a valid number, got True"),
    "wrong type of a count": ("count = 20", "count = 20.5", "cells.count: should be a valid integer, got 20.5"),
    "wrong type of a list": ("edges = [-1, 1]", 'edges = "-1"', "heap.edges: should be a valid list, got '-1'"),
    "key given twice": ("k = 1.0", "k = 1.0\nk = 2.0", "is not TOML"),
    "no scheme 5": ("scheme = 3", "scheme = 5", "method.scheme: should be 1, 2, 3 or 4, got 5"),
    "missing key": ("count = 20", "", "cells.count: missing; give it a value"),
    "unreadable TOML": ("k = 1.0", "k = = 1.0", "is not TOML: Invalid value (at line 4, column 5)"),
    "negative height": ("[0.3, 2.3, 0.3]", "[0.3, -2.3, 0.3]", "heap: height -2.3 at x = -0.9; heights are"),
    "NaN height": ("[0.3, 2.3, 0.3]", "[0.3, nan, 0.3]", "heap.heights[1]: should be a finite number, got nan"),
    "heights and edges": ("[0.3, 2.3, 0.3]", "[0.3, 2.3]", "heap: 2 edges need 3 heights, got 2"),
    "epsilon = 0": ("epsilon = 0.4", "epsilon = 0", "epsilon: should be greater than 0, got 0"),
    "zeta = pi/2": ("zeta = 0.0", 'zeta = "pi/2"', "chute.zeta: should be less than pi/2, got 'pi/2'"),
    "zeta = -pi/2": ("zeta = 0.0", 'zeta = "-pi/2"', "chute.zeta: should be greater than -pi/2, got '-pi/2'"),
    "delta < 0": ('"pi/10"', "-0.1", "friction.delta: should be greater than or equal to 0, got -0.1"),
    "delta = pi/2": ('"pi/10"', '"pi/2"', "friction.delta: should be less than pi/2, got 'pi/2'"),
    "one cell": ("count = 20", "count = 1", "cells.count: should be greater than or equal to 2, got 1"),
    "left = right": ("left = -2", "left = 2", "cells: left = 2 is not below right = 2; exchange or change them"),
    "dt = 0": ("dt = 0.001", "dt = 0", "clock.dt: should be greater than 0, got 0"),
    "two clocks": ("steps = 20", "steps = 20\nend = 1", "clock: dt and steps, or number and end; keep one"),
    "half a clock": ("steps = 20", "", "clock.steps: missing; give it a value"),
    "odd nodes": ("count = 16", "count = 15", "method.velocity: count = 15 is odd, and no velocity"),
    "no nodes": ("count = 16", "count = 0", "method.velocity.count: should be greater than or equal to 2, got 0"),
    "unknown name": ('"pi/10"', '"tau/10"', "friction.delta: 'tau/10': 'tau' is not defined"),
    "no code": ('"pi/10"', "\"__import__('os')\"", "friction.delta: "),
    "expression with an unknown name": (
        'kind = "blocks"\nedges = [-1, 1]\nheights = [0.3, 2.3, 0.3]', 'kind = "expression"\nh = "1 + y"',
        "heap: '1 + y': 'y' is not defined",
    ),
    "no table": (
        'kind = "blocks"\nedges = [-1, 1]\nheights = [0.3, 2.3, 0.3]', 'kind = "table"\npath = "no.csv"',
        "no.csv: cannot be read: No such file or directory",
    ),
    "table that does not increase": (
        'kind = "blocks"\nedges = [-1, 1]\nheights = [0.3, 2.3, 0.3]', 'kind = "table"\npath = "zigzag.csv"',
        "zigzag.csv: x does not increase at data row 3; sort the rows",
    ),
}  # fmt: skip
"""Text to replace in `GOOD`, its replacement, and what the message must hold."""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to stand in, with a good scene file and a table that is not in order."""
    (tmp_path / "small.toml").write_text(GOOD)
    (tmp_path / "zigzag.csv").write_text("x,h\n-2,1\n1,2\n0,1\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", SCENES)
def test_built_in_scenes_are_those_of_the_paper(name):
    scene, method, clock = load_scene(name)
    wanted, ticks = SCENES[name]
    assert scene.title
    for part in ("cells", "heap", "chute", "friction", "boundary", "epsilon", "k"):
        assert getattr(scene, part) == getattr(wanted, part)
    assert clock == ticks
    assert method == Kinetic(scheme=3)
    assert scene.cells.dx == pytest.approx(0.05, abs=1e-15)


def test_built_in_scenes_stand_in_the_order_of_the_figures():
    papers, ours = list(built_in())[:5], list(built_in())[5:]
    assert papers == ["riemann", "silo", "silo-incline", "parabola", "sine"]
    assert [read_keys(name)["figure"] for name in papers] == ["1", "2, 3", "4", "5", "6"]
    assert ours == ["bend", "bend-pressed", "exponential", "jump", "crest", "rest-gallery"]


def test_a_file_needs_no_method_and_its_clock_no_kind(folder):
    text = GOOD[: GOOD.index("[method]")] + "[clock]\nnumber = 0.5\nend = 1\n"
    (folder / "bare.toml").write_text(text)
    scene, method, clock = load_scene(folder / "bare.toml")
    assert method == Kinetic()
    assert clock == Courant(number=0.5, end=1.0)
    assert scene == load_scene("small.toml")[0]


def test_a_table_is_sought_beside_its_scene_file(folder, monkeypatch):
    (folder / "inner").mkdir()
    (folder / "inner" / "heap.csv").write_text("x,h,u\n-2,1,0\n2,3,1\n")
    text = GOOD.replace(
        'kind = "blocks"\nedges = [-1, 1]\nheights = [0.3, 2.3, 0.3]', 'kind = "table"\npath = "heap.csv"'
    )
    (folder / "inner" / "scene.toml").write_text(text)
    scene, _, _ = load_scene("inner/scene.toml")
    assert scene.heap == Table(Path("inner/heap.csv"))
    h, q = scene.initial()
    assert h[0] == pytest.approx(1.05)
    assert q[0] == pytest.approx(1.05 * 0.025)


@pytest.mark.parametrize("name", BAD)
def test_bad_files_get_one_line_with_place_and_remedy(folder, name):
    old, new, wanted = BAD[name]
    assert old in GOOD
    (folder / "small.toml").write_text(GOOD.replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        load_scene("small.toml")
    assert wanted in str(caught.value)
    assert str(caught.value).startswith("small.toml: ")
    assert "\n" not in str(caught.value)


def test_a_number_where_a_table_belongs(folder):
    keys = read_keys("small.toml")
    with pytest.raises(InputError, match=r"^x: cells: should be a table of keys \(in Python Cells\), got 3$"):
        check({**keys, "cells": 3}, "x")
    with pytest.raises(
        InputError, match=r"^x: friction: should be a table of keys \(in Python Frictionless or Coulomb\)"
    ):
        check({**keys, "friction": 3}, "x")


def test_several_faults_are_counted(folder):
    keys = read_keys("small.toml")
    with pytest.raises(InputError, match=r"^x: epsilon: .* \(and 1 more\)$"):
        check({**keys, "epsilon": -1, "k": -1}, "x")


@pytest.mark.parametrize(
    ("name", "wanted"),
    [
        ("sillo", "sillo: no such scene; did you mean silo?"),
        ("nothing-like-it", "no such scene; give a path, or one of bend, bend-pressed"),
        ("no/such.toml", "no/such.toml: cannot be read: No such file or directory"),
        (".", ".: cannot be read: Is a directory"),
        ("latin.toml", "latin.toml: is not UTF-8 text"),
        ("deep.toml", "deep.toml: is not TOML"),
    ],
)
def test_files_that_cannot_be_read(folder, name, wanted):
    (folder / "latin.toml").write_bytes(b'title = "\xe9"')
    (folder / "deep.toml").write_text("a = " + "[" * 10_000)
    with pytest.raises(InputError) as caught:
        load_scene(name)
    assert wanted in str(caught.value)
    assert "\n" not in str(caught.value)


def test_python_values_get_one_line_too():
    with pytest.raises(InputError, match=r"^Uniform\.cuont: unknown key; did you mean count\?$"):
        Uniform(cuont=3)
    with pytest.raises(InputError, match=r"^Fixed\.dt: should be greater than 0, got -1$"):
        Fixed(-1, 10)


def test_settings_change_keys(folder):
    keys = read_keys("small.toml")
    change(
        keys,
        [
            "friction.delta=pi/12",
            "cells.count=40",
            'boundary=["wall", "open"]',
            "title=a b",
            "method.velocity.count=32",
        ],
    )
    file = check(keys, "small.toml")
    assert file.friction.delta == pytest.approx(0.2617993877991494, abs=1e-16)
    assert file.cells.count == 40
    assert file.boundary == ("wall", "open")
    assert file.title == "a b"
    assert file.method == Kinetic(3, Uniform(32))


def test_settings_may_open_a_table():
    keys = {}
    change(keys, ["clock={dt=1, steps=2}", "heap.kind=sine", "x=1\ny=2"])
    assert keys == {"clock": {"dt": 1, "steps": 2}, "heap": {"kind": "sine"}, "x": "1\ny=2"}


@pytest.mark.parametrize("setting", ["delta", "=1", "friction.=1", "cells.count.x=1"])
def test_bad_settings(folder, setting):
    with pytest.raises(InputError, match=rf"^--set {setting}: .*; (write|leave)"):
        change(read_keys("small.toml"), [setting])


def test_taking_the_other_wing_keeps_scheme_and_coupling():
    keys = {"method": {"scheme": 3, "coupling": "face", "velocity": {"count": 64}}}
    take_method(keys, "macroscopic")
    assert keys["method"] == {"kind": "macroscopic", "scheme": 3, "coupling": "face"}
    take_method(keys, "kinetic")
    assert keys["method"] == {"kind": "kinetic", "scheme": 3, "coupling": "face"}
    assert check({**read_keys("silo"), **keys}, "x").method == Kinetic(scheme=3, coupling="face")
    take_method(keys, "macroscopic")
    assert check({**read_keys("silo"), **keys}, "x").method == Macroscopic(scheme=3, coupling="face")
