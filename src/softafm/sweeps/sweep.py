"""Sweeps: experiments or functions over designs of their parameters, kept in a store."""

import shutil
import tempfile
from collections.abc import Callable, Mapping, Sequence
from copy import deepcopy
from math import prod
from pathlib import Path
from time import time
from typing import TYPE_CHECKING, Any

from softafm.checks.refusals import ConfigError
from softafm.checks.validate import check_whole
from softafm.experiment.config import load_document, set_value
from softafm.progress import Progress, make_reporter
from softafm.sweeps.block import FAILED, Block, Work
from softafm.sweeps.campaign import Campaign
from softafm.sweeps.execution import Halted, carry_out, count_cores
from softafm.sweeps.extra import require
from softafm.sweeps.progress import describe_duration
from softafm.sweeps.reading import Table, make_campaign, read_table
from softafm.sweeps.store import RESERVED, Busy, Store, StoreError, create, describe_difference

if TYPE_CHECKING:
    from xarray import Dataset

_MOST_RUNS, _LONGEST = 100_000, 86400.0
_WORK, _MOST_IN_BLOCK, _FEWEST_BLOCKS = 2.0, 1000, 32
"""Expected work in a block, s, most often more than the real one; its most runs; and into how many
blocks a campaign is divided at least."""


def sweep(
    what: str | Path | Mapping[str, Any] | Callable[..., Any],
    vary: Mapping[Any, Any] | None = None,
    *,
    store: str | Path | None = None,
    design: str | None = None,
    samples: int | None = None,
    seed: int | None = None,
    observables: Sequence[str] | None = None,
    batch: int | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    resume: bool = False,
    force: bool = False,
    yes: bool = False,
    progress: bool | Progress | None = None,
) -> "Dataset":
    """Run an experiment, or a function, for many values of its parameters.

    A script that calls it without ``scheduler`` must do so under ``if __name__ == "__main__":``, as
    worker processes read it, too.

    Parameters
    ----------
    what
        An experiment: the path of its TOML file, or its tables as a dictionary; a table ``sweep``
        holds what the arguments leave out. Or a function that takes the parameters by name and
        returns a mapping of names to numbers, or a dataset, whose scalars count.
    vary
        Values of each parameter, a field such as ``"sample.E_inf"``: a sequence of SI numbers or of
        texts with unit, or a range, ``Between(low, high)`` or ``{"from": ..., "to": ..., "points":
        ..., "spacing": "log"}``. A tuple of fields, with a sequence of values for each, varies
        along one dimension.
    store
        Folder of the Zarr store to be written; by default none is kept.
    design
        ``"grid"`` of all combinations, the default, or samples of ranges and lists: ``"random"``,
        ``"latin-hypercube"`` or ``"sobol"``.
    samples, seed
        Number of runs of a sample, and what its random numbers begin from, 0 by default.
    observables
        Names of what to keep; by default all scalars.
    batch
        Runs that a worker is given at a time; by default about a second of work.
    scheduler, workers
        Address of a Dask scheduler; or the number of processes on this machine, by default that of
        its cores, 0 for none but this one. Numbers do not depend on them.
    resume, force
        Go on with a store that the same campaign began, or replace it.
    yes
        Run more than 100 000 runs, or more than a day.
    progress
        None, True for a bar, or a callable (fraction, message).

    Returns
    -------
    xarray.Dataset
        Observables over the varied parameters, of a sample over ``sample``; NaN where a run
        failed. ``state`` is 1 done, 2 failed or 3 done with a warning, ``reason`` and
        ``warning`` the texts. It is read from the store as it is needed.

    Raises
    ------
    ValueError
        If anything cannot be; one line for each problem. Nothing has been run then.
    RuntimeError
        If workers or scheduler are lost for good.
    OSError
        If the store cannot be written. What is finished is kept in both cases, and ``resume``
        goes on.
    """
    given = Table(vary, design, samples, seed, observables, batch)
    if isinstance(what, str | Path):
        document, folder = load_document(what), Path(what).parent
    else:
        document, folder = (deepcopy(dict(what)) if isinstance(what, Mapping) else {}), Path()
    table = given.over(read_table(document.pop("sweep", {})))
    campaign = make_campaign(
        what if callable(what) else document, folder, table, given.vary is None
    )
    options: dict[str, Any] = {"batch": table.batch, "scheduler": scheduler, "workers": workers}
    refuse_size(campaign, scheduler, workers, yes)
    if store is not None:
        kept = conduct(campaign, store, resume=resume, force=force, progress=progress, **options)
        return open_store(kept)
    with tempfile.TemporaryDirectory(prefix="softafm-") as place:
        kept = conduct(campaign, Path(place) / "sweep.zarr", progress=progress, **options)
        return open_store(kept).load()


def refuse_size(campaign: Campaign, scheduler: str | None, workers: int | None, yes: bool) -> None:
    """Raise ConfigError if a campaign is absurdly large, unless ``yes``."""
    hands = count_cores() if workers is None else max(1, workers)
    seconds = (campaign.seconds or 0.0) * campaign.size
    duration = seconds if scheduler is not None else seconds / hands
    if yes or (campaign.size <= _MOST_RUNS and duration <= _LONGEST):
        return
    where = "on one core" if scheduler is not None else f"on {hands} worker{'s' * (hands > 1)}"
    sizes = " × ".join(
        f"{n} of {name}" for name, n in zip(campaign.dimensions, campaign.shape, strict=True)
    )
    raise ConfigError(
        [
            f"sweep: {campaign.size} runs ({sizes}), about {describe_duration(duration)} {where}: "
            "take fewer, or add --yes (in Python yes=True) if that is meant"
        ]
    )


def plan(path: str | Path, overrides: Sequence[str]) -> tuple[Campaign, int | None]:
    """Read a campaign file, with values replaced; return the campaign and its runs a block.

    Raises
    ------
    ConfigError
        One line for each problem.
    """
    document = load_document(path)
    for override in overrides:
        set_value(document, override)
    table = read_table(document.pop("sweep", {}))
    return make_campaign(document, Path(path).parent, table, from_file=True), table.batch


def conduct(
    campaign: Campaign,
    path: str | Path,
    *,
    batch: int | None = None,
    scheduler: str | None = None,
    workers: int | None = None,
    resume: bool = False,
    force: bool = False,
    progress: bool | Progress | None = None,
) -> Store:
    """Do all runs of a campaign that its store lacks, and return the store.

    Parameters and errors are those of ``sweep``.
    """
    store = prepare(
        campaign, path, batch=batch, scheduler=scheduler, workers=workers, resume=resume,
        force=force,
    )  # fmt: skip
    finish(campaign, store, scheduler, workers, progress)
    return store


def prepare(
    campaign: Campaign,
    path: str | Path,
    *,
    batch: int | None,
    scheduler: str | None,
    workers: int | None,
    resume: bool,
    force: bool,
) -> Store:
    """Refuse what cannot be, and return the store to be filled: a new one, or one begun before."""
    if scheduler is not None or workers != 0:
        require("dask", "distributed")
    if scheduler is not None and "://" not in scheduler:
        raise ConfigError([f"scheduler = {scheduler}: must be an address, such as tcp://host:8786"])
    if workers is not None:
        check_whole("workers", workers, 0, 10_000)
        if scheduler is not None:
            raise ConfigError([f"workers = {workers}: those of {scheduler} are its own; leave it"])
    if batch is not None:
        check_whole("sweep.batch", batch, 1, 1_000_000)
    for name in (*(o.name for o in campaign.observables), *campaign.coordinates):
        if name in RESERVED:
            raise ConfigError([f"'{name}': is a name that every store uses; choose another"])
    return _find_store(campaign, Path(path), batch, resume, force)


def finish(
    campaign: Campaign,
    store: Store,
    scheduler: str | None,
    workers: int | None,
    progress: bool | Progress | None,
) -> None:
    """Do all runs that a store lacks."""
    work = Work(campaign.run, {o.name: o.shape for o in campaign.observables})
    with store.writing(), make_reporter(progress) as report:
        missing = store.missing()
        left = sum(prod(map(len, store.ranges(number))) for number in missing)
        begun, done, failed = time(), 0, 0

        def keep(number: int, block: Block) -> None:
            nonlocal done, failed
            store.write(number, block)
            done += block.state.size
            failed += int((block.state == FAILED).sum())
            if report is not None:
                ready = store.size - left + done
                seconds = (time() - begun) / done * (left - done)
                words = f"{ready} of {store.size} runs" + (f", {failed} failed" if failed else "")
                report(ready / store.size, f"{words}, {describe_duration(seconds)} left")

        if missing and report is not None:
            report(1 - left / store.size, "workers start")
        if missing:
            store.begin()
            blocks = ((number, campaign.points(store.ranges(number))) for number in missing)
            carry_out(work, blocks, keep, scheduler=scheduler, workers=workers)


def _find_store(
    campaign: Campaign, path: Path, batch: int | None, resume: bool, force: bool
) -> Store:
    """Return the store to be filled: a new one, or one that this campaign began."""
    there = path.exists() or path.is_symlink()
    if there and resume:
        store = Store(path)
        difference = describe_difference(store, campaign)
        if difference is not None:
            raise StoreError(f"{path}: was begun by another campaign: {difference}")
        return store
    if there and not force:
        raise StoreError(
            f"{path}: exists; choose another name, or add --resume to continue it, or --force to "
            "replace it"
        )
    if there:
        with Store(path).writing():  # refuses what is no store, or in use
            shutil.rmtree(path)
    return create(path, campaign, batch or _choose_batch(campaign))


def _choose_batch(campaign: Campaign) -> int:
    """Return how many runs to give a worker at a time."""
    runs = _WORK / max(campaign.seconds or 0.0, _WORK / _MOST_IN_BLOCK)
    return max(1, min(int(runs), -(-campaign.size // _FEWEST_BLOCKS)))


def open_store(store: Store) -> "Dataset":
    """Return a store as a dataset that reads values as they are needed."""
    from xarray import open_zarr

    return open_zarr(store.path, chunks=None, consolidated=True, zarr_format=2)


def load_sweep(path: str | Path) -> "Dataset":
    """Read the store of a sweep whole, finished or not; runs not done are NaN, their ``state`` 0.

    Raises
    ------
    ValueError
        If it is not the store of a sweep, or a part of it is damaged.
    """
    from xarray import Dataset

    store = Store(Path(path))
    attributes = dict(store.attributes)
    coordinates = str(attributes.pop("coordinates", "")).split()
    arrays = store.load()
    try:
        loaded = Dataset(arrays, attrs=attributes)
        return loaded.set_coords([name for name in coordinates if name in arrays])
    except ValueError as error:
        raise StoreError(f"{path}: is damaged ({error})") from None


__all__ = ["Busy", "Halted", "conduct", "finish", "load_sweep", "plan", "prepare", "sweep"]
