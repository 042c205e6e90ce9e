"""Results as netCDF files, written under another name and renamed, so that half a file never bears the final name."""

from __future__ import annotations

import io
import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from .errors import InputError

if TYPE_CHECKING:
    import xarray


def check_destination(path: str | Path) -> Path:
    """`path`, if a file can be put there.

    Raises:
        InputError: Its folder does not exist or cannot be written, or it is a folder or a device.
    """
    path = Path(path)
    folder = path.parent
    try:
        if not folder.is_dir():
            raise InputError(f"{path}: the folder {folder} does not exist; create it first")
        if path.is_dir():
            raise InputError(f"{path}: is a folder; name a file in it")
        if path.exists() and not path.is_file():
            raise InputError(f"{path}: is a device or a pipe; name an ordinary file")
    except OSError as error:
        raise InputError(f"{str(path)[:80]}: is no name for a file ({error.strerror}); take another") from None
    try:
        tempfile.TemporaryFile(dir=folder).close()
    except OSError as error:
        raise InputError(f"{path}: cannot write into {folder} ({error.strerror}); choose another folder") from None
    return path


@contextmanager
def replacing(path: str | Path) -> Iterator[str]:
    """The name of a file to write in place of `path`; it takes that name at the end, and vanishes after an error.

    Raises:
        InputError: The file cannot be put there.
    """
    path = check_destination(path)
    handle, name = tempfile.mkstemp(dir=path.parent, prefix=f".{path.name}.", suffix=".part")
    os.close(handle)
    try:
        yield name
        os.chmod(name, 0o666 & ~_umask())
        _flush(name)
        os.replace(name, path)
        _flush(path.parent)
    except OSError as error:
        raise InputError(f"{path}: cannot be written ({error.strerror or error}); nothing was kept there") from None
    finally:
        Path(name).unlink(missing_ok=True)


def write_netcdf(dataset: xarray.Dataset, path: str | Path) -> Path:
    """Write `dataset` to `path`, all of it or nothing.

    Raises:
        InputError: The file cannot be put there.
    """
    packed = io.BytesIO()  # HDF5 does not survive a disk that is full
    dataset.to_netcdf(packed, engine="h5netcdf", invalid_netcdf=False)
    return write_bytes(packed.getbuffer(), path)


def write_text(text: str, path: str | Path) -> Path:
    """Write `text` to `path`, all of it or nothing.

    Raises:
        InputError: The file cannot be put there.
    """
    return write_bytes(text.encode("utf-8"), path)


def write_bytes(content: bytes | memoryview, path: str | Path) -> Path:
    """Write `content` to `path`, all of it or nothing.

    Raises:
        InputError: The file cannot be put there.
    """
    with replacing(path) as name:
        Path(name).write_bytes(content)
    return Path(path)


def _flush(path: str | Path) -> None:
    """On the disk before the next line: a name must not outlive a power cut that its content does not."""
    if os.name == "nt" and Path(path).is_dir():  # Windows opens no folders, and keeps names by itself
        return
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _umask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask
