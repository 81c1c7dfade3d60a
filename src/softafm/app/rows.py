"""The list of runs as the browser draws it: where each stands, in words."""

from typing import Any

from softafm.app.session import Entry
from softafm.units.quantities import write_quantity


def make_row(entry: Entry) -> dict[str, Any]:
    """Return a run as ``page.js`` draws it."""
    words, bad = _describe_state(entry)
    return {
        "id": entry.id,
        "label": entry.label,
        "colour": entry.colour,
        "shown": entry.shown,
        "state": entry.state,
        "fraction": entry.job.fraction if entry.job else 1.0,
        "words": words,
        "bad": bad,
    }


def _describe_state(entry: Entry) -> tuple[str, bool]:
    """Return where an entry stands, and whether that is bad."""
    job = entry.job
    if job is None:
        return "uploaded", False
    if entry.state == "waiting":
        return f"waiting, number {job.place} in the queue", False
    if entry.state == "running":
        left = "" if job.remaining is None else f", about {describe_time(job.remaining)} left"
        return f"{describe_time(job.elapsed)}{left}; {job.message}".rstrip("; "), False
    if entry.state == "done":
        warned = f"; doubtful: {' '.join(entry.warnings)}" if entry.warnings else ""
        return f"done in {describe_time(job.elapsed)}{warned}", bool(warned)
    return (job.problem or entry.state), entry.state == "failed"


def describe_time(seconds: float) -> str:
    """Return a time as people say it."""
    if seconds < 1:
        return write_quantity(float(f"{seconds:.2g}"), "s")
    if seconds < 60:
        return f"{seconds:.0f} s"
    if seconds < 3600:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"
