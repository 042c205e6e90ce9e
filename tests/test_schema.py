"""The schema of scene files agrees with what reads them."""

from __future__ import annotations

import json
import tomllib

import pytest
from jsonschema import Draft7Validator
from test_cli import kinsim
from test_read import GOOD

from kinsim import InputError
from kinsim.read import built_in, check, read_keys
from kinsim.schema import scene_schema

SCHEMA = scene_schema()
WINDOW = 'velocity = {kind = "window", dxi = 0.1}'
UNIFORM = 'velocity = {kind = "uniform", count = 16}'
PARABOLA = 'kind = "parabola"\npeak = "1/2"'
BLOCKS = 'kind = "blocks"\nedges = [-1, 1]\nheights = [0.3, 2.3, 0.3]'

CHANGES = {
    "none": ("", ""),
    "a formula": ("zeta = 0.0", 'zeta = "pi/20"'),
    "a method that is not named": ('kind = "kinetic"\n', ""),
    "velocities that are not named": ('kind = "uniform", ', ""),
    "another velocity space": (UNIFORM, WINDOW),
    "a velocity space that must be named": (UNIFORM, "velocity = {dxi = 0.1}"),
    "another clock": ("dt = 0.001\nsteps = 20", "number = 0.4\nend = 1"),
    "two clocks": ("dt = 0.001", "dt = 0.001\nend = 1"),
    "another heap": (BLOCKS, PARABOLA),
    "a heap that is not named": ('kind = "blocks"', ""),
    "an unknown heap": ('"blocks"', '"bricks"'),
    "two ends": ('"open"', '["open", "wall"]'),
    "mixed ends": ('"open"', '["open", "periodic"]'),
    "three ends": ('"open"', '["open", "wall", "wall"]'),
    "an unknown key": ("k = 1.0", "kay = 1.0"),
    "an unknown key deep down": ("count = 16", "cuont = 16"),
    "a key that is missing": ("count = 20", ""),
    "a bound that is reached": ("epsilon = 0.4", "epsilon = 0"),
    "a bound that is passed": ("steps = 20", "steps = 0"),
    "a truth": ("epsilon = 0.4", "epsilon = true"),
    "half a cell": ("count = 20", "count = 20.5"),
    "no scheme 5": ("scheme = 3", "scheme = 5"),
}


def is_good(keys: dict) -> bool:
    try:
        check(keys, "scene")
    except InputError:
        return False
    return True


def test_it_is_a_schema():
    Draft7Validator.check_schema(SCHEMA)


@pytest.mark.parametrize("name", built_in())
def test_the_built_in_scenes_keep_it(name):
    Draft7Validator(SCHEMA).validate(read_keys(name))


@pytest.mark.parametrize("name", CHANGES)
def test_it_judges_as_the_reader_does(name):
    old, new = CHANGES[name]
    assert old in GOOD
    keys = tomllib.loads(GOOD.replace(old, new, 1))
    assert Draft7Validator(SCHEMA).is_valid(keys) == is_good(keys)


def test_both_judgements_are_among_them():
    judged = [is_good(tomllib.loads(GOOD.replace(old, new, 1))) for old, new in CHANGES.values()]
    assert sum(judged) == 8


def test_keys_are_explained_where_one_points_at_them():
    explained = SCHEMA["definitions"]["Kinetic"]["properties"]["limiter"]["description"]
    assert explained.startswith("Of order 2:")
    assert "pressure" in SCHEMA["properties"]["k"]["description"]
    assert "Attributes" not in json.dumps(SCHEMA)


def test_the_command_prints_or_writes_it(tmp_path):
    assert json.loads(kinsim("schema").output) == SCHEMA
    assert kinsim("schema", "-o", str(tmp_path / "scene.json")).output == ""
    assert json.loads((tmp_path / "scene.json").read_text()) == SCHEMA
    assert "does not exist; create it first" in kinsim("schema", "-o", str(tmp_path / "no/s.json"), code=2).stderr
