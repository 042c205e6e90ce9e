"""Tables of numbers in CSV files: a line of names, then rows; the first column increases."""

from __future__ import annotations

import csv
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError


def read_columns(path: Path, allowed: Sequence[Sequence[str]]) -> dict[str, NDArray[np.float64]]:
    """The columns by name; their names are one of the `allowed` lines.

    Raises:
        InputError: It cannot be read, or is no such table; the message names file, row and remedy.
    """
    if path.exists() and not path.is_file():
        raise InputError(f"table {path}: is no ordinary file; give a CSV file")
    try:
        with path.open(newline="", encoding="utf-8-sig") as file:
            rows = list(csv.reader(line for line in file if line.strip() and not line.lstrip().startswith("#")))
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        reason = getattr(error, "strerror", None) or "it is not a CSV file"
        raise InputError(f"table {path}: cannot be read: {reason}") from None
    header = [name.strip() for name in rows[0]] if rows else []
    if header not in [list(names) for names in allowed]:
        wanted = " or ".join(",".join(names) for names in allowed)
        raise InputError(f"table {path}: the first line must be {wanted}, got {','.join(header)[:60]!r}")
    try:
        columns = np.array([[float(entry) for entry in row] for row in rows[1:]], dtype=float).reshape(-1, len(header))
    except ValueError:
        raise InputError(f"table {path}: each row needs {len(header)} numbers; look for gaps and words") from None
    if len(columns) < 2 or not np.isfinite(columns).all():
        raise InputError(f"table {path}: needs at least two rows of finite numbers")
    falls = np.flatnonzero(np.diff(columns[:, 0]) <= 0)
    if falls.size:
        raise InputError(f"table {path}: {header[0]} does not increase at data row {falls[0] + 2}; sort the rows")
    return dict(zip(header, columns.T.copy(), strict=True))
