"""What classes and functions from outside of the package consist of: their source, and all that they read."""

from __future__ import annotations

import inspect
import sys
from typing import Any


def is_built_in(part: Any) -> bool:
    """Whether a class or function is one of the package, and does not only say so."""
    module, name = getattr(part, "__module__", None) or "", getattr(part, "__qualname__", "")
    found: Any = sys.modules.get(module) if module.startswith("kinsim.") else None
    for step in name.split("."):
        found = getattr(found, step, None)
    return found is not None and getattr(found, "py_func", found) is getattr(part, "py_func", part)


def told(part: Any) -> str:
    """The source of a class or function from outside, and of all that it reads: compiled code freezes it."""
    found: dict[str, str] = {}
    _gather(part, found)
    return repr(sorted(found.items()))


def _gather(part: Any, found: dict[str, str]) -> None:
    part = getattr(part, "py_func", part)
    name = f"{getattr(part, '__module__', '')}.{getattr(part, '__qualname__', type(part).__qualname__)}"
    if name in found:
        return
    found[name] = _source(part)
    formulas = [part]
    if inspect.isclass(part):
        formulas = [getattr(entry, "fget", entry) for entry in vars(part).values()]
        for base in part.__mro__[1:]:
            _note(f"{name}: {base.__qualname__}", base, found)
    for formula in (getattr(entry, "py_func", entry) for entry in formulas):
        if not inspect.isfunction(formula):
            continue
        found[f"{name}: {formula.__name__}"] = repr((formula.__defaults__, formula.__kwdefaults__))
        read = inspect.getclosurevars(formula)
        for key, value in {**read.globals, **read.nonlocals}.items():
            if inspect.ismodule(value):
                for entry in formula.__code__.co_names if _is_ours(value.__name__) else ():
                    _note(f"{name}: {key}.{entry}", getattr(value, entry, None), found)
            else:
                _note(f"{name}: {key}", value, found)


def _note(place: str, value: Any, found: dict[str, str]) -> None:
    """A value that a formula reads; a function or class by its source, and by what it reads itself."""
    plain = getattr(value, "py_func", value)
    if not (inspect.isfunction(plain) or inspect.isclass(plain)):
        text = repr(value.tolist() if hasattr(value, "tolist") else value)
        found[place] = type(value).__qualname__ if " at 0x" in text else text  # an address says nothing
    elif _is_ours(plain.__module__ or ""):
        _gather(plain, found)


def _is_ours(module: str) -> bool:
    """Whether a module may change from run to run: it is no library."""
    return module.split(".")[0] not in {*sys.stdlib_module_names - {"__main__"}, "kinsim", "numpy", "numba", "scipy"}


def _source(part: Any) -> str:
    """The source of a class or function; its code where there is no source."""
    try:
        return inspect.getsource(part)
    except (OSError, TypeError):
        codes = [part] if hasattr(part, "__code__") else list(getattr(part, "__dict__", {}).values())
        return repr([(code.__code__.co_code, code.__code__.co_consts) for code in codes if hasattr(code, "__code__")])
