"""Formulas in scene files: arithmetic on finite numbers and nothing else.

The evaluator is simpleeval, narrowed: no attributes, no subscripts, no strings, no bit operations, and every constant
a float, so that neither code nor memory can run away.
"""

from __future__ import annotations

import ast
import math
import warnings
from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from simpleeval import DEFAULT_OPERATORS, InvalidExpression, SimpleEval

from .errors import InputError

LONGEST = 1000
"""Characters that a formula may have."""

CONSTANTS = {"pi": math.pi, "e": math.e}

FUNCTIONS: dict[str, Callable[..., Any]] = {
    "abs": abs, "min": min, "max": max, "sqrt": math.sqrt, "exp": math.exp, "log": math.log,
    "sin": math.sin, "cos": math.cos, "tan": math.tan, "asin": math.asin, "acos": math.acos, "atan": math.atan,
    "sinh": math.sinh, "cosh": math.cosh, "tanh": math.tanh, "floor": math.floor, "ceil": math.ceil,
}  # fmt: skip

OPERATORS = {
    node: DEFAULT_OPERATORS[node]
    for node in (ast.Add, ast.Sub, ast.Mult, ast.Div, ast.Mod, ast.Pow, ast.UAdd, ast.USub, ast.Not,
                 ast.Eq, ast.NotEq, ast.Lt, ast.LtE, ast.Gt, ast.GtE)
}  # fmt: skip

NODES = (ast.Expr, ast.UnaryOp, ast.BinOp, ast.BoolOp, ast.Compare, ast.IfExp, ast.Call, ast.Name, ast.Constant)


class _Arithmetic(SimpleEval):  # type: ignore[misc]
    """simpleeval without everything that arithmetic does not need."""

    def __init__(self, names: dict[str, float]) -> None:
        super().__init__(operators=OPERATORS, functions=FUNCTIONS, names=names)
        self.nodes: dict[type, Callable[..., Any]] = {node: call for node, call in self.nodes.items() if node in NODES}
        self.nodes[ast.Constant] = self._constant

    @staticmethod
    def _constant(node: ast.Constant) -> float:
        if isinstance(node.value, bool) or not isinstance(node.value, (int, float)):
            raise InvalidExpression(f"{node.value!r} is not a number")
        return float(node.value)


def evaluate(formula: str, x: ArrayLike | None = None) -> Any:
    """Evaluate `formula`, once, or for each entry of `x`.

    Args:
        formula: Arithmetic with pi, e, the usual functions, comparisons and ``a if condition else b``;
            with `x` given also the name x.
        x: Places, any shape, or None for a formula without variables.

    Returns:
        A float, or a float array of the shape of `x`.

    Raises:
        InputError: It cannot be read, names something unknown, or has no finite value (at the place named).
    """
    if len(formula) > LONGEST:
        raise InputError(f"formula of {len(formula)} characters; at most {LONGEST} are read")
    if x is None:
        return _at(formula, _Arithmetic(dict(CONSTANTS)))
    places: NDArray[np.float64] = np.ascontiguousarray(x, dtype=float)
    return np.frombuffer(_values(formula, places.tobytes())).reshape(places.shape).copy()


@lru_cache(maxsize=32)  # a scene asks for the same values many times, and each takes microseconds
def _values(formula: str, places: bytes) -> bytes:
    arithmetic = _Arithmetic({**CONSTANTS})
    values = []
    for place in np.frombuffer(places).tolist():
        arithmetic.names["x"] = place
        values.append(_at(formula, arithmetic))
    return np.array(values).tobytes()


def check_names(formula: str) -> None:
    """See that `formula` can be read and that x and the known names are all it uses.

    Raises:
        InputError: It does not.
    """
    if len(formula) > LONGEST:
        raise InputError(f"formula of {len(formula)} characters; at most {LONGEST} are read")
    known = {"x", *CONSTANTS, *FUNCTIONS}
    for node in ast.walk(_parsed(formula)):
        if isinstance(node, ast.Name) and node.id not in known:
            raise InputError(f"{_short(formula)}: {node.id!r} is not defined; known names: {', '.join(sorted(known))}")


@lru_cache(maxsize=64)
def _parsed(formula: str) -> ast.AST:
    try:
        with warnings.catch_warnings():  # "1if 2 else 3" and the like: read, or not
            warnings.simplefilter("ignore")
            return ast.parse(formula.strip(), mode="eval").body  # one expression, and no second one after it
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise InputError(f"cannot read the formula {_short(formula)}") from None


def _at(formula: str, arithmetic: _Arithmetic) -> float:
    names = arithmetic.names
    where = f" at x = {names['x']:g}" if "x" in names else ""
    tree = _parsed(formula)
    try:
        result = arithmetic.eval(formula, previously_parsed=tree)
        number = float(result)
    except KeyError as error:  # a comparison that is not arithmetic
        raise InputError(f"{_short(formula)}: operator {getattr(error.args[0], '__name__', '')} is not known") from None
    except RecursionError:
        raise InputError(f"{_short(formula)} is nested too deeply; write it in fewer terms") from None
    except InvalidExpression as error:
        if "<ast." in str(error):
            raise InputError(f"{_short(formula)} uses an operator that formulas do not have") from None
        known = ", ".join(sorted([*names, *FUNCTIONS]))
        raise InputError(f"{_short(formula)}: {str(error) or type(error).__name__}; known names: {known}") from None
    except (ArithmeticError, ValueError, TypeError) as error:
        raise InputError(f"{_short(formula)} has no value{where}: {error}") from None
    if not math.isfinite(number):
        raise InputError(f"{_short(formula)} is not finite{where}")
    return number


def _short(formula: str) -> str:
    return repr(formula if len(formula) <= 60 else formula[:57] + "...")
