"""A run becomes a film."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

from pydantic import Field

from ..read import check, read_keys
from ..run import Run
from ..simulation import Progress
from ..store import replacing
from ..value import Whole, checked
from .reel import Frames, Reel, reel_of
from .shoot import shoot
from .stored import read_reel
from .writers import WRITERS, Film, check_film

FRAMES, RATE, WIDTH = 100, 20, 900

Rate = Annotated[Whole, Field(ge=1, le=50)]
Width = Annotated[Whole, Field(ge=200, le=2000)]


def animate(
    shown: Run | str | Path,
    path: str | Path,
    *,
    twin: Run | None = None,
    frames: int = FRAMES,
    rate: int = RATE,
    width: int = WIDTH,
    progress: Progress | None = None,
) -> Path:
    """Make a film: the density over (x, xi) beside h and u; without a density where the method is macroscopic.

    f is shown where it was kept along with the saved states, `simulate(..., save_every=50, dumps=[Dump(every=50)])`;
    otherwise M of the saved h and u. All quantities shown are dimensionless.

    Args:
        shown: A run, the path of a stored one (``.nc``), or the name or path of a scene, which is then run, a kinetic
            one with its closed-form twin.
        path: Where the film goes: ``.gif``, ``.html`` (a page with a scrub bar that needs nothing else) or ``.mp4``
            (made by ffmpeg).
        twin: Another run of the same scene, whose h and u are drawn, too, at the same times.
        frames: At most so many, 2 to 600, evenly spread over the time of the run.
        rate: Frames per second, 1 to 50.
        width: In pixels, 200 to 2000.
        progress: Called now and then with the share of the frames that is done.

    Returns:
        `path`.

    Raises:
        InputError: There is no such run or scene, a number is out of its bounds, the film cannot be put there, or
            ffmpeg is missing.
    """
    check_film(path)
    check_shape(frames, rate, width)
    if isinstance(shown, Run):
        reel = reel_of(shown, frames, twin)
    elif is_stored(shown):
        reel = read_reel(shown, frames)
    else:
        reel = reel_of(*_shot(str(shown), frames))
    return project(reel, path, rate, width, progress)


def check_shape(frames: int, rate: int, width: int) -> None:
    """Refuse numbers that no film can have, before anything is run."""
    for name, kind, given in (("frames", Frames, frames), ("rate", Rate, rate), ("width", Width, width)):
        checked(f"film: {name}", kind, given)


def is_stored(shown: str | Path) -> bool:
    """Whether it names a stored run rather than a scene."""
    return Path(shown).suffix.lower() == ".nc"


def project(reel: Reel, path: str | Path, rate: int, width: int, progress: Progress | None = None) -> Path:
    """Draw the frames of `reel` into a file, all of it or nothing."""
    from ..plot.film import Pictures

    path = check_film(path)
    film = Film(Pictures(reel, width), reel.t.tolist(), rate, reel.title, progress or (lambda share: None))
    with replacing(path) as name:
        WRITERS[path.suffix.lower()](film, name)
    return path


def _shot(name: str, frames: int) -> tuple[Run, int, Run | None]:
    run, *twin = shoot(check(read_keys(name), name), frames)
    return run, frames, twin[0] if twin else None
