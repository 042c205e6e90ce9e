"""Who runs the members: this process, or workers of Dask distributed."""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from typing import Any, Protocol

from ..errors import InputError
from ..interrupt import Deferred
from .member import Member
from .record import Record, failed, perform

Tell = Callable[[str, float], None]
"""Called with what is under way and the share that is done."""

PATIENCE = 30.0
"""Seconds after which a scheduler that does not answer is given up."""

ONE_THREAD = {f"{name}_NUM_THREADS": "1" for name in ("NUMBA", "OMP", "OPENBLAS", "MKL", "VECLIB_MAXIMUM", "NUMEXPR")}


class Engine(Protocol):
    """Gives the record of each member as soon as there is one."""

    def __call__(self, members: Mapping[str, Member], tell: Tell) -> Iterator[tuple[str, Record]]: ...


@dataclass(frozen=True)
class InProcess:
    """One after the other, here."""

    def __call__(self, members: Mapping[str, Member], tell: Tell) -> Iterator[tuple[str, Record]]:
        for number, (key, member) in enumerate(members.items()):
            what = f"member {number + 1} of {len(members)}"
            begun = number / len(members)
            tell(what, begun)
            record = perform(member, lambda share, at=begun, say=what: tell(say, at + share / len(members)))  # type: ignore[misc]
            if record.figures["verdict_kind"] == "interrupted":
                raise KeyboardInterrupt
            yield key, record


@dataclass(frozen=True)
class Cluster:
    """`workers` processes of this machine with a thread each, or those of a running scheduler at `address`."""

    workers: int = 0
    address: str | None = None

    def __call__(self, members: Mapping[str, Member], tell: Tell) -> Iterator[tuple[str, Record]]:
        dask = _dask()
        if not members:
            return
        with ExitStack() as stack:
            client = stack.enter_context(self._client(dask, stack))
            tell(f"{len(members)} members on the cluster", 0.0)
            futures = {
                client.submit(perform, member, key=f"kinsim-{key}", pure=True): key for key, member in members.items()
            }
            stack.callback(client.cancel, list(futures))
            for done, future in enumerate(dask.as_completed(list(futures)), start=1):
                error = future.exception()
                record = failed("error", f"{type(error).__name__}: {error}") if error else future.result()
                if record.figures["verdict_kind"] == "interrupted":
                    raise KeyboardInterrupt
                yield futures[future], record
                future.release()
                tell(f"{done} of {len(members)} members", done / len(members))

    def _client(self, dask: Any, stack: ExitStack) -> Any:
        if self.address is None:
            at: Any = self._processes(dask, stack)
        else:
            at = self.address
        try:
            return dask.Client(at, timeout=PATIENCE)
        except (OSError, ValueError, TimeoutError) as error:
            raise InputError(f"--scheduler {self.address}: cannot be reached ({error}); start one there") from None

    def _processes(self, dask: Any, stack: ExitStack) -> Any:
        """Workers of our own; a Ctrl-C while they start waits until they can be stopped."""
        with Deferred() as interrupt, _unseen():
            try:
                started = stack.enter_context(
                    dask.LocalCluster(
                        n_workers=self.workers, threads_per_worker=1, processes=True, host="127.0.0.1",
                        dashboard_address=None, env=ONE_THREAD, silence_logs=logging.CRITICAL,
                    )
                )  # fmt: skip
            except Exception:
                if not interrupt.asked:
                    raise
        if interrupt.asked:
            raise KeyboardInterrupt
        return started


@contextmanager
def _unseen() -> Iterator[None]:
    """Processes that start in here write nothing to the terminal: Ctrl-C reaches them, too, while they still import."""
    sys.stderr.flush()
    kept, nowhere = os.dup(2), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, 2)
    try:
        yield
    finally:
        os.dup2(kept, 2)
        os.close(kept)
        os.close(nowhere)


def engine(workers: int = 0, scheduler: str | None = None) -> Engine:
    """This process, unless workers or a scheduler are named.

    Raises:
        InputError: Both are, or a number of workers is none, or the extra for them is missing.
    """
    if isinstance(workers, bool) or not isinstance(workers, int) or workers < 0:
        raise InputError(f"study: workers = {workers!r} is no number of processes; take 0 for none, or more")
    if scheduler is not None and not isinstance(scheduler, str):
        raise InputError(f"study: scheduler = {scheduler!r} is no address; take one such as 'tcp://127.0.0.1:8786'")
    if not workers and scheduler is None:
        return InProcess()
    if workers and scheduler is not None:
        raise InputError("study: a scheduler has workers of its own; leave out --workers, or --scheduler")
    _dask()
    return Cluster(workers, scheduler)


def _dask() -> Any:
    try:
        import distributed
    except ImportError:
        raise InputError("study: workers need an extra; install it with: pip install 'kinsim[cluster]'") from None
    return distributed
