"""A function of the user's own, by its module and name."""

from __future__ import annotations

import importlib
import sys
from pathlib import Path
from typing import Any

from .errors import InputError


def load_flux(place: str) -> Any:
    """The function at ``module:name``; the current folder counts as part of the Python path.

    Raises:
        InputError: There is no such module or function.
    """
    module_name, colon, name = place.partition(":")
    if not (module_name and colon and name):
        raise InputError(f"{place}: is not MODULE:NAME; write for example kinsim.printed:flux")
    here = str(Path.cwd())
    if here not in sys.path:
        sys.path.insert(0, here)
    try:
        module = importlib.import_module(module_name)
    except Exception as error:  # importing runs the user's code, which may raise anything
        raise InputError(f"{place}: {module_name} cannot be imported: {type(error).__name__}: {error}") from error
    found = getattr(module, name, None)
    if not callable(found):
        raise InputError(f"{place}: {module_name} has no function {name!r}")
    return found
