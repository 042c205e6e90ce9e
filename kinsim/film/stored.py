"""Runs that were stored, read as far as a film needs them."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

from pydantic import TypeAdapter, ValidationError

from ..errors import InputError
from ..method import Kinetic, Macroscopic, Method
from ..scene import Scene
from .reel import Reel, cut

if TYPE_CHECKING:
    import xarray


def read_reel(path: str | Path, frames: int) -> Reel:
    """At most `frames` rows of the run that `kinsim run --out` wrote to `path`; no other part of it is read.

    Raises:
        InputError: It is no such file.
    """
    import xarray

    path = Path(path)
    if not path.is_file():
        raise InputError(f"{path}: there is no such file; make it with kinsim run NAME --out {path}")
    try:
        with xarray.open_dataset(path, engine="h5netcdf") as stored:
            return _reel(stored, path, frames)
    except (OSError, RuntimeError) as error:
        raise InputError(f"{path}: is no netCDF file, or a broken one ({_line(error)}); write it anew") from None


def _reel(stored: xarray.Dataset, path: Path, frames: int) -> Reel:
    if not {"scene", "method"} <= stored.attrs.keys() or not {"t", "x", "h", "u"} <= stored.variables.keys():
        raise InputError(f"{path}: holds no run; make one with kinsim run NAME --out {path}")
    t, h, u = (stored[name].to_numpy() for name in ("t", "h", "u"))
    scene, method = _values(stored.attrs, h[0], u[0], path)
    return cut(scene, method, t, h, u, _dumps(stored), frames)


def _values(attrs: dict[str, Any], h: Any, u: Any, path: Path) -> tuple[Scene, Kinetic | Macroscopic]:
    """Scene and method; the heap is the first row, so that a table that it came from may be gone."""
    heap = {"kind": "profile", "h": h.tolist(), "u": u.tolist()}
    try:
        scene = TypeAdapter(Scene).validate_python(json.loads(attrs["scene"]) | {"heap": heap})
        return scene, TypeAdapter(Method).validate_python(json.loads(attrs["method"]))
    except (ValidationError, ValueError, TypeError, InputError) as error:
        wrote = f"kinsim {attrs.get('kinsim_version', 'of an unknown version')} wrote it"
        raise InputError(f"{path}: its scene or method cannot be read ({_line(error)}); {wrote}") from None


def _dumps(stored: xarray.Dataset) -> dict[str, xarray.DataArray]:
    """Densities in all cells, on axes that are called t, x and xi again."""
    found = {}
    for name, array in stored.data_vars.items():
        if array.ndim == 3 and array.dims[1] == "x" and str(array.dims[2]).startswith("xi"):
            own = {axis: axis.removesuffix(f"_{name}") for axis in map(str, array.coords)}
            found[str(name)] = array.rename({old: new for old, new in own.items() if old != new})
    return found


def _line(error: Exception) -> str:
    return " ".join(str(error).split())[:120]
