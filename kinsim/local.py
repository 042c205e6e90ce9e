"""What the ground has: one number for all of it, or a number per cell or face.

Kernels ask with `at`, `left` and `right`, so that each is written once. For a number the compiler leaves nothing of
the question: code for constant slopes is what it would be without.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
from numba import types
from numba.extending import overload
from numpy.typing import NDArray

Array = NDArray[np.float64]

Local = float | Array
"""One number, or an array of them."""

Sides = Local | tuple[Array, Array]
"""The same, or arrays of the left and of the right side of faces."""


def at(value: Local, i: int) -> float:
    """The number that belongs to place i."""
    return float(value[i]) if isinstance(value, np.ndarray) else value


def left(value: Sides) -> Local:
    """What belongs to the left sides of faces."""
    return value[0] if isinstance(value, tuple) else value


def right(value: Sides) -> Local:
    """What belongs to the right sides of faces."""
    return value[1] if isinstance(value, tuple) else value


def varies(value: Local) -> bool:
    """Whether it is a number per place."""
    return isinstance(value, np.ndarray)


def _in_kernels(question: Callable[..., Any], answer: Callable[..., Any]) -> None:
    overload(question, jit_options={"error_model": "numpy", "forceinline": True}, strict=False)(answer)


@partial(_in_kernels, at)
def _at(value: Any, i: Any) -> Any:
    return (lambda value, i: value[i]) if isinstance(value, types.Array) else (lambda value, i: value)


@partial(_in_kernels, left)
def _left(value: Any) -> Any:
    return (lambda value: value[0]) if isinstance(value, types.BaseTuple) else (lambda value: value)


@partial(_in_kernels, right)
def _right(value: Any) -> Any:
    return (lambda value: value[1]) if isinstance(value, types.BaseTuple) else (lambda value: value)


@partial(_in_kernels, varies)
def _varies(value: Any) -> Any:
    return (lambda value: True) if isinstance(value, types.Array) else (lambda value: False)
