"""Covering cases: every pair that can meet does, in few cases."""

from __future__ import annotations

import itertools
from collections.abc import Callable
from typing import Any

import pytest
from covering import covering

AXES = ("ab", range(4), [{}, {"order": 2}, {"order": 3}], (0.0, 1.0, 2.0, 3.0), [[1], [2]])
"""192 cases; dictionaries and lists among the values."""


def pairs(cases: list[tuple[Any, ...]]) -> set[str]:
    """Each two values that meet, with their places."""
    return {repr(pair) for case in cases for pair in itertools.combinations(enumerate(case), 2)}


WHERE = {"all": lambda *case: True, "some": lambda *case: case[0] == "a" or case[1] < 2}


@pytest.mark.parametrize("where", WHERE.values(), ids=WHERE)
def test_all_pairs_meet_in_few_cases(where: Callable[..., bool]) -> None:
    cases = covering(*AXES, where=where)
    product = [case for case in itertools.product(*AXES) if where(*case)]
    assert pairs(cases) == pairs(product)
    assert all(case in product for case in cases)
    assert len(cases) <= 20  # 16 is the least
    assert cases == covering(*AXES, where=where)


def test_a_single_axis_is_all_of_its_values() -> None:
    assert covering("abc") == [("a",), ("b",), ("c",)]
