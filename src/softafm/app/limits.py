"""What a server lets each of its users do."""

from dataclasses import dataclass

from softafm.checks.validate import check_positive, check_whole


@dataclass(frozen=True)
class Limits:
    """Bounds of what users of the page may ask for.

    Parameters
    ----------
    processes
        How many runs may go on at the same time, of all users together.
    waiting
        How many runs of one user may wait.
    listed
        How many runs one user may keep listed.
    run_seconds
        How long a run may be expected to take, and may take, s.
    upload_bytes
        Size of the largest file that is accepted, bytes.
    kept_bytes
        Memory from which on the results of one user leave no room for another, bytes; no single
        one may have more.

    Raises
    ------
    ValueError
        If one is out of range.
    """

    processes: int = 1
    waiting: int = 4
    listed: int = 20
    run_seconds: float = 600.0
    upload_bytes: int = 20_000_000
    kept_bytes: int = 500_000_000

    def __post_init__(self) -> None:
        check_whole("processes", self.processes, 1, 256)
        check_whole("waiting", self.waiting, 1, 10_000)
        check_whole("listed", self.listed, 1, 1000)
        check_positive("run_seconds", self.run_seconds, "s")
        check_whole("upload_bytes", self.upload_bytes, 1000, 2_000_000_000)
        check_whole("kept_bytes", self.kept_bytes, 1000, 10**12)
