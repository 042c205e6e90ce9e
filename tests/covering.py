"""Few cases instead of a full product: those in which each two values of two axes meet."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Iterable, Sequence
from typing import Any


def fewest(sets: Sequence[set[Any]]) -> list[int]:
    """Places of a few sets that hold what all of them hold: each the first of those that add most."""
    missing, chosen = set().union(*sets), []
    while missing:
        chosen.append(max(range(len(sets)), key=lambda i: len(sets[i] & missing)))
        missing -= sets[chosen[-1]]
    return chosen


def covering(*axes: Iterable[Any], where: Callable[..., bool] = lambda *case: True) -> list[tuple[Any, ...]]:
    """Cases, one value of each axis in each, in which all pairs meet that do in any case which `where` lets pass.

    The same axes give the same cases, and where any value would do, the first one stands. Values are told apart by
    their places, so that they need not be hashable.
    """
    pool = [case for case in itertools.product(*map(enumerate, axes)) if where(*(value for _, value in case))]
    places = [[(axis, at) for axis, (at, _) in enumerate(case)] for case in pool]
    pairs = [set(itertools.combinations(case, min(2, len(case)))) for case in places]
    return [tuple(value for _, value in pool[i]) for i in fewest(pairs)]
