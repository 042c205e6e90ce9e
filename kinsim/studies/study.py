"""Many runs of one scene with some of its values replaced."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..clock import Courant, Fixed
from ..method import Kinetic, Macroscopic
from ..run import describe
from ..scene import Scene
from .dataset import to_dataset
from .engine import Tell, engine
from .given import check_count, check_given
from .member import ONCE, Member, Refused, Request, code_stamp
from .record import Keep, Record, check_fields, failed, kept_in
from .vary import check_over, vary

if TYPE_CHECKING:
    import xarray


def study(
    scene: Scene,
    method: Kinetic | Macroscopic,
    clock: Fixed | Courant,
    over: Mapping[str, Sequence[Any]],
    *,
    paired: bool = False,
    fields: Sequence[str] | str = (),
    save_every: int = ONCE,
    force: bool = False,
    repeats: int = 1,
    traced: bool = False,
    keep: str | Path | None = None,
    resume: bool = False,
    workers: int = 0,
    scheduler: str | None = None,
    tell: Tell | None = None,
) -> xarray.Dataset:
    """Run a scene with some of its values, its method's or its clock's replaced by each of a list.

    In a script, workers need ``if __name__ == "__main__":`` around what starts them.

    Args:
        scene: What happens.
        method: How it is computed.
        clock: When.
        over: By dotted path, as in a scene file ("chute.zeta", "method.velocity.count", "clock.dt", or a whole
            "method"): the values.
        paired: Take the lists side by side instead of every combination.
        fields: Histories to keep, or one: "h", "q", "u", or columns of the ledger, every `save_every` steps.
        save_every: Steps from one row of a history to the next.
        force: Run although the CFL bound (28) is broken.
        repeats: So often all members are run in turn; times are kept of each round, all else of the first.
        traced: Measure the memory that each run takes at most, which makes it slower.
        keep: Folder for finished members, each written at once; None keeps nothing.
        resume: Take from it what was computed before, by the same code.
        workers: Processes to start; 0 runs the members here. Needs the extra ``kinsim[cluster]``.
        scheduler: Address of a Dask scheduler that runs.
        tell: Called with what is under way and the share that is done.

    Returns:
        A dimension per path, or "member" if paired: h, u (dimensions x, or cell with coordinates x where cells vary)
        and the ledger at the end, `history_...` of the fields, verdict, wall_time (s), steps, cell_steps; all
        dimensionless but for times. A member that fails is a row with its verdict ("refused" if its values do not
        go together, "error" if it broke) and NaN.

    Raises:
        InputError: Nothing varies, not one member can be run, or an argument makes no sense.
        KeyboardInterrupt: Ctrl-C; finished members are in `keep`.
    """
    check_given("study", scene, method, clock)
    check_count("study: repeats", repeats, "take 1 to run each member once")
    check_count("study: save_every", save_every, "take 1 to keep each state")
    lists = check_over(over, paired)
    request = Request(check_fields(fields), save_every, force, traced)
    rows = vary(scene, method, clock, lists, paired, request)
    rounds = [[_again(row, number) for row in rows] for number in range(repeats)]
    members = [one for again in rounds for one in again if isinstance(one, Member)]
    found = iter(collect(members, keep=keep, resume=resume, workers=workers, scheduler=scheduler, tell=tell))
    attrs = {
        "title": f"{scene.title or 'untitled'}: a study over {', '.join(lists)}",
        "scene": describe(Scene, scene),
        "method": describe(type(method), method),
        "clock": describe(type(clock), clock),
        "version": code_stamp(),
    }
    records = [[next(found) if isinstance(one, Member) else failed("refused", one.message) for one in again]
               for again in rounds]  # fmt: skip
    return to_dataset(lists, paired, records, attrs)


def collect(
    members: Sequence[Member],
    *,
    keep: str | Path | None = None,
    resume: bool = False,
    workers: int = 0,
    scheduler: str | None = None,
    tell: Tell | None = None,
) -> list[Record]:
    """The record of each member, those that were kept first; options as those of `study`."""
    kept, wanted = kept_in(keep, resume), {one.key: one for one in members}
    found = {key: record for key in wanted if (record := kept.load(key)) is not None}
    rest = {key: member for key, member in wanted.items() if key not in found}
    before = len(found)

    def whole(what: str, share: float) -> None:
        if tell:
            tell(what, (before + share * len(rest)) / len(wanted))

    with _counted(found, wanted, kept):
        for key, record in engine(workers, scheduler)(rest, whole):
            kept.save(key, record)
            found[key] = record
    return [found[one.key] for one in members]


@contextmanager
def _counted(found: Mapping[str, Record], members: Mapping[str, Member], kept: Keep) -> Iterator[None]:
    """An interrupt says how much was done."""
    try:
        yield
    except KeyboardInterrupt:
        raise KeyboardInterrupt(f"{len(found)} of {len(members)} members are done, {kept.words}") from None


def _again(row: Member | Refused, number: int) -> Member | Refused:
    return replace(row, repeat=number) if isinstance(row, Member) and number else row
