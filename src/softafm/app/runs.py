"""Runs in processes of their own, one after another for each: a queue, progress and cancel.

The processes stay warm between runs. One that crashes, or is ended to cancel its run, is replaced;
callers only ever see a ``Job``.
"""

import threading
from collections import Counter
from collections.abc import Mapping
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Any, Literal
from uuid import uuid4

from softafm.app.files import refuse_paths
from softafm.app.process import GONE, Process

if TYPE_CHECKING:
    from xarray import Dataset


State = Literal["waiting", "running", "done", "failed", "cancelled"]

_LEAST_KNOWN = 0.02
"""Part of a run that must be done before the rest can be estimated."""


class Job:
    """One run, from the queue to its result; every attribute may be read at any time.

    Attributes
    ----------
    id, document, user
        Which run it is, what it runs, and for whom.
    state
        ``"waiting"``, ``"running"``, ``"done"``, ``"failed"`` or ``"cancelled"``.
    fraction, message
        How far the run is, 0 to 1, and its own words for it.
    result
        The dataset once the state is ``"done"``.
    problem
        One line that says why it failed, or None.
    warnings
        What the run warned of, a line each.
    """

    def __init__(self, runner: "Runner", document: Mapping[str, Any], folder: Path, user: str):
        self.id = uuid4().hex[:12]
        self.document, self.folder, self.user = document, folder, user
        self.state: State = "waiting"
        self.fraction, self.message = 0.0, ""
        self.result: Dataset | None = None
        self.problem: str | None = None
        self.warnings: tuple[str, ...] = ()
        self._runner = runner
        self._started = self._stopped = 0.0
        self._over = threading.Event()

    @property
    def place(self) -> int:
        """Place in the queue, 1 = next; 0 when it no longer waits."""
        return self._runner._place_of(self)

    @property
    def elapsed(self) -> float:
        """How long it has been running, or ran, s."""
        if not self._started:
            return 0.0
        return (self._stopped or monotonic()) - self._started

    @property
    def remaining(self) -> float | None:
        """Estimate of how long it will still run, s; None while it is unknown."""
        done = self.fraction
        if self.state != "running" or done < _LEAST_KNOWN:
            return None
        return self.elapsed * max(1 - done, 0.0) / done

    def cancel(self) -> None:
        """Take it from the queue, or end its process; nothing happens if it is over."""
        self._runner._end(self, "cancelled", stop=True)

    def wait(self, timeout: float | None = None) -> bool:
        """Wait until it is over, at most ``timeout`` s; return whether it is."""
        return self._over.wait(timeout)


class Runner:
    """Processes that run experiments, and the queue before them.

    The queue is first come, first served, but the second run of one user comes after the first of
    any other.

    Parameters
    ----------
    processes
        How many runs may go on at the same time.
    per_user
        How many runs one user may have waiting.
    time_limit
        Time after which a run is ended, s.
    largest
        Size above which a result is refused, bytes.
    """

    def __init__(
        self,
        processes: int = 1,
        per_user: int = 4,
        time_limit: float = 600.0,
        largest: int = 500_000_000,
    ):
        self.processes, self.per_user = processes, per_user
        self.time_limit, self.largest = time_limit, largest
        self._changed = threading.Condition(threading.RLock())
        self._waiting: list[Job] = []
        self._running: dict[Job, Process] = {}
        self._alive: set[Process] = set()
        self._threads: list[threading.Thread] = []
        self._closed = False

    def start(self) -> None:
        """Begin to start and warm up the processes, and return at once."""
        for number in range(self.processes):
            name = f"softafm-run-{number}"
            self._threads.append(threading.Thread(target=self._serve, name=name, daemon=True))
            self._threads[-1].start()

    def close(self) -> None:
        """Cancel all runs and end the processes."""
        with self._changed:
            self._closed = True
            for job in [*self._waiting, *self._running]:
                self._end(job, "cancelled", stop=True)
            for process in self._alive:
                process.kill()
            self._changed.notify_all()
        for thread in self._threads:
            thread.join()

    def __enter__(self) -> "Runner":
        self.start()
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    @property
    def ready(self) -> bool:
        """Whether a process is warm; the first start after an installation compiles first."""
        with self._changed:
            return any(process.alive for process in self._alive)

    def submit(self, document: Mapping[str, Any], folder: Path, user: str) -> Job:
        """Queue a run of an experiment; its files are in ``folder``.

        Raises
        ------
        ValueError
            If the user has too many runs waiting already, a file is not named by a plain name, or
            the runner is closed.
        """
        refuse_paths(document)
        job = Job(self, document, folder, user)
        with self._changed:
            if self._closed:
                raise ValueError("no more runs are taken: the server is closing")
            if sum(other.user == user for other in self._waiting) >= self.per_user:
                raise ValueError(
                    f"{self.per_user} of your runs are waiting already: cancel one, or wait for it"
                )
            self._waiting.append(job)
            self._changed.notify()
        return job

    def _order(self) -> list[Job]:
        """Return the waiting jobs in the order they will run."""
        ahead = Counter(job.user for job in self._running)
        rounds = {}
        for job in self._waiting:
            rounds[job] = ahead[job.user]
            ahead[job.user] += 1
        return sorted(self._waiting, key=rounds.__getitem__)

    def _place_of(self, job: Job) -> int:
        with self._changed:
            return self._order().index(job) + 1 if job.state == "waiting" else 0

    def _end(
        self,
        job: Job,
        state: State,
        *,
        result: "Dataset | None" = None,
        problem: str | None = None,
        stop: bool = False,
    ) -> None:
        """Give a job its last state, unless it has one; ``stop`` ends a process still at it."""
        with self._changed:
            if job._over.is_set():
                return
            if job.state == "waiting":
                self._waiting.remove(job)
            elif stop:
                self._running[job].kill()
            job.result, job.problem = result, problem
            job._stopped, job.state = monotonic(), state
            job._over.set()

    def _serve(self) -> None:
        """Keep one process, and give it one job after another, until the runner is closed."""
        import xarray as xr  # results hold its datasets, and this is not the time they come

        del xr
        process = None
        while not self._closed:
            if process is None or not process.alive:
                self._forget(process)
                process = self._new_process()
            job = self._take(process)
            if job is not None:
                self._carry_out(job, process)
        self._forget(process)

    def _new_process(self) -> Process:
        """Start a process and wait until it is warm or gone."""
        process = Process(self.largest)
        with self._changed:
            self._alive.add(process)
            if self._closed:
                process.kill()
        process.warm_up()
        return process

    def _forget(self, process: Process | None) -> None:
        if process is not None:
            with self._changed:
                self._alive.discard(process)
            process.close()

    def _take(self, process: Process) -> Job | None:
        """Return the next job, now running; None if none comes soon or the process is gone."""
        with self._changed:
            if not self._waiting:
                self._changed.wait(timeout=1.0)
            if not self._waiting or self._closed:
                return None
            job = self._order()[0]
            if not process.warm:
                self._end(job, "failed", problem=f"no run could be started: {process.last_words}")
                return None
            if not process.alive:
                return None
            self._waiting.remove(job)
            self._running[job] = process
            job._started, job.state = monotonic(), "running"
            return job

    def _carry_out(self, job: Job, process: Process) -> None:
        late = f"it took longer than a run may take here, {self.time_limit:g} s"
        clock = threading.Timer(
            self.time_limit, self._end, (job, "failed"), {"problem": late, "stop": True}
        )
        clock.daemon = True
        clock.start()
        try:
            process.ask(job.document, str(job.folder))
            while not job._over.is_set():
                kind, content = process.answer()
                if kind == "progress":
                    job.fraction, job.message = content
                elif kind == "warning":
                    job.warnings += (content,)
                elif kind == "result":
                    job.fraction = 1.0
                    self._end(job, "done", result=content)
                else:
                    self._end(job, "failed", problem=content)
        except GONE:
            self._end(job, "failed", problem=f"the run ended early: {process.last_words}")
        finally:
            clock.cancel()
            with self._changed:
                del self._running[job]
