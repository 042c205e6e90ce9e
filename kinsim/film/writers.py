"""Frames become a file: one writer for each kind of film."""

from __future__ import annotations

import base64
import html
import io
import json
import shutil
import subprocess
import tempfile
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from string import Template
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from ..errors import InputError
from ..store import check_destination

if TYPE_CHECKING:
    from PIL.Image import Image

Frame = NDArray[np.uint8]
PAGE = Path(__file__).parent / "page.html"


@dataclass(frozen=True)
class Film:
    """What the writers take; iterating over it draws, and tells the share that is done.

    Attributes:
        frames: Each of shape (height, width, 3).
        times: What the frames show, one for each.
        rate: Frames per second.
        title: A line for people.
        tell: Called with the share.
    """

    frames: Sequence[Frame]
    times: Sequence[float]
    rate: int
    title: str
    tell: Callable[[float], None]

    def __iter__(self) -> Iterator[Frame]:
        for row, frame in enumerate(self.frames):
            self.tell(row / len(self.frames))
            yield frame

    def images(self) -> Iterator[Image]:
        """The frames in 256 colours, the same for all: those of a few frames, and what is next to white is white."""
        from PIL import Image

        last = len(self.frames) - 1
        few = np.concatenate([self.frames[row] for row in sorted({0, last // 4, last // 2, last})])
        palette = Image.fromarray(few).quantize(256, Image.Quantize.MEDIANCUT)
        colours = np.reshape(palette.getpalette() or [], (-1, 3))
        colours[(colours > 247).all(axis=1)] = 255
        palette.putpalette(colours.ravel().tolist())
        for frame in self:
            yield Image.fromarray(frame).quantize(palette=palette, dither=Image.Dither.NONE)


def check_film(path: str | Path) -> Path:
    """`path`, if a film can be put there.

    Raises:
        InputError: Its suffix names no kind of film, no file can be put there, or what makes it is missing.
    """
    path = Path(path)
    suffix = path.suffix.lower()
    if suffix not in WRITERS:
        raise InputError(f"{path}: is no film; end its name in {', '.join(WRITERS)}")
    if suffix == ".mp4" and shutil.which("ffmpeg") is None:
        raise InputError(f"{path}: mp4 is made by ffmpeg, which is not found; install it, or take .gif or .html")
    return check_destination(path)


def write_gif(film: Film, name: str) -> None:
    """An animated GIF that begins anew at its end, all frames in the colours of a few."""
    drawn = film.images()
    next(drawn).save(
        name, format="gif", save_all=True, append_images=drawn, duration=round(1000 / film.rate), loop=0,
        comment=film.title.encode(),
    )  # fmt: skip


def write_html(film: Film, name: str) -> None:
    """A page with a scrub bar that holds all frames and fetches nothing."""
    frames = []
    for image in film.images():
        with io.BytesIO() as file:
            image.save(file, format="png")
            frames.append(base64.b64encode(file.getvalue()).decode("ascii"))
    page = Template(PAGE.read_text(encoding="utf-8")).substitute(
        title=html.escape(film.title), frames=json.dumps(frames), times=json.dumps(film.times), rate=film.rate,
        last=len(frames) - 1, width=film.frames[0].shape[1],
    )  # fmt: skip
    Path(name).write_text(page, encoding="utf-8")


def write_mp4(film: Film, name: str) -> None:
    """H.264 by ffmpeg, which takes the frames from a pipe.

    Raises:
        InputError: ffmpeg fails; the message has its last line.
    """
    height, width, _ = film.frames[0].shape
    taken = f"-f rawvideo -pixel_format rgb24 -video_size {width}x{height} -framerate {film.rate} -i -"
    given = "-vf pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white -pix_fmt yuv420p -f mp4 -y"
    command = ["ffmpeg", "-loglevel", "error", *taken.split(), *given.split(), name]
    with tempfile.TemporaryFile() as said:
        with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=said, stderr=said) as process:
            assert process.stdin is not None
            with suppress(BrokenPipeError):
                for frame in film:
                    process.stdin.write(frame.tobytes())
                process.stdin.close()
        if process.returncode:
            said.seek(0)
            lines = said.read().decode(errors="replace").split("\n")
            why = next((line for line in reversed(lines) if line.strip()), f"exit code {process.returncode}")
            raise InputError(f"ffmpeg could not make the film: {why}; take .gif or .html instead")


WRITERS: dict[str, Callable[[Film, str], None]] = {".gif": write_gif, ".html": write_html, ".mp4": write_mp4}
"""By suffix."""
