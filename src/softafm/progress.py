"""A progress bar for whatever takes over a second."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import perf_counter
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.progress import Progress as Bar
    from rich.progress import TaskID

Progress = Callable[[float, str], None]


@contextmanager
def make_reporter(progress: bool | Progress | None) -> Iterator[Progress | None]:
    """Turn a mode's ``progress`` argument into a callable (fraction, message), or None.

    True gives a bar on stderr that appears after one second and vanishes at the end.
    """
    if progress is not True:
        yield progress or None
        return
    started = perf_counter()
    shown: list[tuple[Bar, TaskID]] = []

    def report(fraction: float, message: str) -> None:
        if not shown:
            if perf_counter() - started < 1:
                return
            from rich.console import Console
            from rich.progress import Progress as Bar

            bar = Bar(console=Console(stderr=True), transient=True)
            bar.start()
            shown.append((bar, bar.add_task("", total=1.0)))
        bar, task = shown[0]
        bar.update(task, completed=fraction, description=message)

    try:
        yield report
    finally:
        for bar, _ in shown:
            bar.stop()
