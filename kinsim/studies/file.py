"""A study as a file: netCDF with everything, or CSV with a row per member."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from ..errors import InputError
from ..store import check_destination, write_netcdf, write_text

if TYPE_CHECKING:
    import xarray


def check_study_file(path: str | Path, fields: Sequence[str] = ()) -> Path:
    """`path`, if a study can be written there, with its fields.

    Raises:
        InputError: It is neither .nc nor .csv, or there are fields and it is .csv, or no file can be put there.
    """
    if Path(path).suffix.lower() not in (".nc", ".csv"):
        raise InputError(f"{path}: a study is written as .nc (all of it) or .csv (a row per member); take one of these")
    if fields and Path(path).suffix.lower() == ".csv":
        asked, other = " ".join(f"--field {name}" for name in fields), Path(path).with_suffix(".nc")
        raise InputError(f"{path}: a .csv has a row per member and no room for {asked}; write {other}")
    return check_destination(path)


def write_study(found: xarray.Dataset, path: str | Path) -> Path:
    """Write what `study` returns; a CSV file has all but what varies over the cells or from row to row of a member.

    Raises:
        InputError: The file cannot be put there.
    """
    if Path(path).suffix.lower() != ".csv":
        return write_netcdf(found, path)
    flat = found.drop_dims([name for name in ("cell", "x", "row", "repeat") if name in found.sizes])
    return write_text(flat.to_dataframe().reset_index().to_csv(index=False), path)
