"""Blocks of runs on Dask: few in flight at a time, and done again when a worker is lost.

It knows nothing of where runs come from, nor where their results go.
"""

import logging
import multiprocessing
import os
import pickle
import sys
import tempfile
import threading
import warnings
from asyncio import CancelledError
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass
from itertools import islice
from typing import TYPE_CHECKING, Any

import softafm
from softafm.sweeps.block import Block, Work, join_lines
from softafm.sweeps.isolated import carry_apart

if TYPE_CHECKING:
    from distributed import Client

Keep = Callable[[int, Block], None]
"""Takes the number of a block and what its runs gave."""

_MOST_LOSSES = 5
_CONNECT = 10.0
"""Time in which a scheduler must answer, s."""
_LOGGERS = ("distributed", "tornado", "asyncio", "dask")
_SETTINGS = {
    # One loss is enough to suspect a block, and to do its runs apart.
    "distributed.scheduler.allowed-failures": 0,
    # A long run may keep a worker from telling that it is alive.
    "distributed.scheduler.worker-ttl": None,
    # What Dask keeps for those who look into it: the last messages, with the points of a block
    # each, and profiles. With how often it looks at itself, they took a tenth of two cores.
    "distributed.admin.low-level-log-length": 10,
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.admin.system-monitor.interval": "10s",
    "distributed.worker.memory.monitor-interval": "1s",
    "distributed.scheduler.work-stealing": False,
    "distributed.scheduler.active-memory-manager.start": False,
}
"""Of a cluster that is started here."""
_ONE_AT_A_TIME = threading.Lock()


class Halted(RuntimeError):
    """Runs cannot go on, for no fault of theirs; the message says why."""


@dataclass
class _Task:
    """A block on its way."""

    number: int
    points: Sequence[Any]
    losses: int = 0


def count_cores() -> int:
    """Return how many processor cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return max(1, len(os.sched_getaffinity(0)))
    return os.cpu_count() or 1


def carry_out(
    work: Work,
    blocks: Iterable[tuple[int, Sequence[Any]]],
    keep: Keep,
    *,
    scheduler: str | None = None,
    workers: int | None = None,
) -> None:
    """Do the runs of all blocks, and hand over what they give in whatever order they finish.

    Parameters
    ----------
    work
        What to do with every point of a block; pickled once.
    blocks
        Numbers and points, taken only when they are soon to be done.
    keep
        Called in this thread for every block.
    scheduler
        Address of a Dask scheduler; by default a cluster is started on this machine.
    workers
        Number of processes of that cluster, by default that of the cores; 0 does everything here.

    Raises
    ------
    Halted
        If no scheduler answers, it goes away, or workers cannot do the work.
    ValueError
        If the address is none, or the number of workers.
    """
    if scheduler is None and workers == 0:
        for number, points in blocks:
            keep(number, work(points))
        return
    with _connect(scheduler, workers) as client:
        _carry_out_by(client, work, iter(blocks), keep)


def _carry_out_by(
    client: "Client", work: Work, blocks: Iterator[tuple[int, Sequence[Any]]], keep: Keep
) -> None:
    import cloudpickle
    from distributed import as_completed
    from distributed.comm import CommClosedError
    from distributed.scheduler import KilledWorker

    tasks: dict[Any, _Task] = {}
    try:
        # A task as any other: Dask does it again where it is lost.
        pickled = cloudpickle.dumps(work)
        unpacked = client.submit(_unpack, pickled, _list_versions(), pure=False)
        under_way = as_completed(loop=client.loop)

        def send(task: _Task) -> None:
            # Pickled, as what Dask understands it keeps for a while, piece by piece.
            points = cloudpickle.dumps(task.points)
            future = client.submit(_do_block, unpacked, points, task.losses > 0, pure=False)
            tasks[future.key] = task
            under_way.add(future)

        while True:
            for number, points in islice(blocks, max(0, _count_in_flight(client) - len(tasks))):
                send(_Task(number, points))
            if not tasks:
                break
            future = next(under_way)
            task = tasks.pop(future.key)
            try:
                block = future.result()
            except KilledWorker:
                task.losses += 1
                if task.losses > _MOST_LOSSES:
                    raise Halted("workers are lost again and again; see their logs") from None
                if unpacked.status == "error":  # one was lost while it unpacked
                    unpacked = client.submit(_unpack, pickled, _list_versions(), pure=False)
                send(task)
                continue
            except (CancelledError, CommClosedError):
                raise
            except Exception as error:
                reason = join_lines(f"{type(error).__name__}: {error}")
                raise Halted(f"the workers cannot do this work: {reason}") from None
            del future
            keep(task.number, block)
    except (CancelledError, CommClosedError, StopIteration):
        raise Halted("the scheduler is gone, or was told to drop the work") from None


def _count_in_flight(client: "Client") -> int:
    """Return how many blocks keep all workers busy: two for each, so that none has to wait."""
    return max(4, 2 * sum(client.nthreads().values()))


def _list_versions() -> dict[str, str]:
    return {"softafm": softafm.__version__, "Python": ".".join(map(str, sys.version_info[:2]))}


def _unpack(pickled: bytes, versions: dict[str, str]) -> Work:
    """Unpickle the work, on a worker."""
    if (ours := _list_versions()) != versions:
        name = next(name for name in versions if versions[name] != ours[name])
        raise RuntimeError(f"a worker has {name} {ours[name]}, and not {versions[name]}")
    return pickle.loads(pickled)


def _do_block(work: Work, pickled: bytes, apart: bool) -> Block:
    """Do a block on a worker, where one is done at a time, however many threads it has."""
    points = pickle.loads(pickled)
    with _ONE_AT_A_TIME:
        return carry_apart(work, points) if apart else work(points)


@contextmanager
def _connect(scheduler: str | None, workers: int | None) -> Iterator["Client"]:
    """Connect to a scheduler, or start one with workers; they say nothing."""
    with ExitStack() as stack:
        stack.enter_context(_silence())
        import dask
        from distributed import Client, LocalCluster

        stack.enter_context(dask.config.set(_SETTINGS))
        try:
            if scheduler is None:
                if getattr(multiprocessing.current_process(), "_inheriting", False):
                    sys.exit(1)  # a worker that reads the script that starts it: that one tells
                folder = stack.enter_context(tempfile.TemporaryDirectory(prefix="softafm-"))
                scheduler = stack.enter_context(
                    LocalCluster(
                        n_workers=workers or count_cores(),
                        threads_per_worker=1,
                        processes=True,
                        host="127.0.0.1",
                        dashboard_address=None,
                        silence_logs=logging.CRITICAL + 1,
                        local_directory=folder,
                        preload="softafm.sweeps.local_worker",
                    )
                )
            client = stack.enter_context(Client(scheduler, timeout=_CONNECT, set_as_default=False))
        except (OSError, RuntimeError) as error:
            if isinstance(scheduler, str):
                raise Halted(f"scheduler = {scheduler}: {join_lines(str(error))}") from None
            raise Halted(
                f"no worker processes could be started: {join_lines(str(error))} (a script must "
                "sweep under if __name__ == '__main__':)"
            ) from None
        yield client


@contextmanager
def _silence() -> Iterator[None]:
    """Keep what Dask logs and warns of from the user, who is told all that matters by us."""
    loggers = [logging.getLogger(name) for name in _LOGGERS]
    levels = [logger.level for logger in loggers]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        for logger in loggers:
            logger.setLevel(logging.CRITICAL + 1)
        try:
            yield
        finally:
            for logger, level in zip(loggers, levels, strict=True):
                with suppress(ValueError):
                    logger.setLevel(level)
