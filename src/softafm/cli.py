"""The command line: ``softafm example``, ``info``, ``show``, ``run``, ``plot``, ``docs`` and more.

Everything heavy is imported inside the commands, so that ``softafm --help`` answers at once.
"""

import io
import os
import signal
import sys
import tempfile
import threading
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from softafm.errors import AccuracyWarning, DoubtfulValueWarning

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from xarray import Dataset

SUCCESS, FAILURE, BAD_INPUT = 0, 1, 2
_TYPER_INTERRUPTED = 130
_PICTURES = (".png", ".pdf", ".svg")

app = typer.Typer(
    name="softafm",
    help="Simulate atomic force microscopy on soft, adhesive, viscoelastic surfaces.",
    no_args_is_help=False,
    add_completion=False,
    pretty_exceptions_enable=False,
)

Config = Annotated[Path, typer.Argument(help="Experiment file in TOML.", metavar="CONFIG.toml")]
Result = Annotated[Path, typer.Argument(help="Result of a run.", metavar="RESULT.nc")]
Force = Annotated[bool, typer.Option("--force", help="Overwrite an existing output.")]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", help="Replace a value, e.g. sample.E0=3GPa.", metavar="KEY=VALUE"),
]


class _BadInput(Exception):
    """The user's input cannot be used; the message is for them."""


class _Failure(Exception):
    """Good input, but the work could not be finished; the message is for the user."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line and return its exit code: 0 success, 2 bad input, 1 failure."""
    try:
        with _show_warnings():
            code = app(args=arguments, prog_name="softafm", standalone_mode=False)
        return _report_interruption() if code == _TYPER_INTERRUPTED else int(code or SUCCESS)
    except typer.TyperException as error:  # how typer reports a wrong option or argument
        return _complain(f"{error.format_message()} (see softafm --help)", BAD_INPUT)
    except _BadInput as error:
        return _complain(str(error), BAD_INPUT)
    except _Failure as error:
        return _complain(str(error), FAILURE)
    except (KeyboardInterrupt, typer.Abort):
        return _report_interruption()
    except Exception as error:
        if os.environ.get("SOFTAFM_TRACEBACK"):
            raise
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        return _complain(f"{reason} (SOFTAFM_TRACEBACK=1 shows where)", FAILURE)


@app.callback(invoke_without_command=True)
def _softafm(
    context: typer.Context,
    version: Annotated[bool, typer.Option("--version", help="Show the version.")] = False,
) -> None:
    if version:
        from softafm.version import __version__

        typer.echo(f"softafm {__version__}")
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


@app.command()
def run(
    config: Config,
    out: Annotated[Path | None, typer.Option(help="Result; default CONFIG.nc here.")] = None,
    overrides: Overrides = None,
    solver: Annotated[str | None, typer.Option(help="Name of the solver.")] = None,
    tolerance: Annotated[str | None, typer.Option(help="Target relative error.")] = None,
    profiles: Annotated[bool, typer.Option("--profiles", help="Keep surface profiles.")] = False,
    check: Annotated[
        bool, typer.Option("--check", help="Repeat the run finer and compare.")
    ] = False,
    regularise: Annotated[
        str | None,
        typer.Option(help="Lower the Tabor number to this, or auto, or none.", metavar="NUMBER"),
    ] = None,
    force: Force = False,
) -> None:
    """Run an experiment file, save the result and show its observables."""
    changes = list(overrides or [])
    changes += [f"solver.name={solver}"] if solver is not None else []
    changes += [f"run.tolerance={tolerance}"] if tolerance is not None else []
    changes += ["run.profiles=true"] if profiles else []
    changes += ["run.check=true"] if check else []
    changes += [f"run.regularise={regularise}"] if regularise is not None else []
    with _report_bad_input():
        from softafm.draw.summary import list_observables
        from softafm.experiment.config import load_experiment
        from softafm.results import datasets as results

        experiment = load_experiment(config, changes)
        out = _choose_output(out, f"{config.stem}.nc", (".nc",), force)
    dataset = _carry_out("run", experiment.run)
    _save(partial(results.save, dataset), out, force)
    _print(list_observables(dataset))
    typer.echo(f"saved {out}")


@app.command()
def scan(
    config: Annotated[Path, typer.Argument(help="Map file in TOML.", metavar="MAP.toml")],
    out: Annotated[Path | None, typer.Option(help="Result; default MAP.nc here.")] = None,
    overrides: Overrides = None,
    workers: Annotated[int | None, typer.Option(help="Processes; default one per core.")] = None,
    force: Force = False,
) -> None:
    """Image the sample of a map file, save the maps and show their ranges."""
    with _report_bad_input():
        from softafm.checks.validate import check_whole
        from softafm.draw.summary import list_observables
        from softafm.maps.map_file import load_map
        from softafm.results import datasets as results

        workers = _count_cores() if workers is None else check_whole("--workers", workers, 1, 1024)
        experiment = load_map(config, overrides or [])
        out = _choose_output(out, f"{config.stem}.nc", (".nc",), force)
    dataset = _carry_out("scan", partial(experiment.run, workers))
    _save(partial(results.save, dataset), out, force)
    _print(list_observables(dataset))
    typer.echo(f"saved {out}")


def _carry_out(what: str, run: "Callable[..., Dataset]") -> "Dataset":
    """Return the result of a run, and show its progress; if it ends early, one line says why."""
    from softafm.experiment.config import ConfigError

    try:
        with _show_progress() as progress:
            return run(progress)
    except ConfigError as error:
        raise _BadInput(str(error)) from error
    except RuntimeError as error:
        raise _Failure(f"the {what} failed: {error}") from error


def _count_cores() -> int:
    """Return how many cores this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return max(1, len(os.sched_getaffinity(0)))
    return os.cpu_count() or 1


@app.command()
def example(
    name: Annotated[str | None, typer.Argument(help="Which one; without a name, list all.")] = None,
    out: Annotated[Path | None, typer.Option(help="File; default NAME.toml here.")] = None,
    force: Force = False,
) -> None:
    """List the bundled experiment and map files, or write one to start from."""
    from softafm.experiment.config import list_examples, list_maps, read_example

    if name is None:
        for known in [*list_examples(), *list_maps()]:
            title = read_example(known).splitlines()[0].lstrip("# ")
            typer.echo(f"{known:20} {title}")
        typer.echo("write one with: softafm example NAME")
        return
    with _report_bad_input():
        text = read_example(name)
        out = _choose_output(out, f"{name}.toml", (".toml",), force)
    _save_content(text.encode(), out, force)
    command = "scan" if name in list_maps() else "run"
    typer.echo(f"wrote {out}; run it with: softafm {command} {out}")


@app.command()
def docs(
    name: Annotated[str | None, typer.Argument(help="Which page; none lists them.")] = None,
) -> None:
    """List the pages of the documents, or show one."""
    from softafm.files.documents import folder, page_text, page_titles

    if name is None:
        for known, title in page_titles().items():
            typer.echo(f"{known:20} {title}")
        typer.echo(f"show one with: softafm docs NAME; all are in {folder()}")
        return
    with _report_bad_input():
        text = page_text(name)
    if not sys.stdout.isatty():
        typer.echo(text, nl=False)
        return
    from rich.markdown import Markdown

    _print(Markdown(text))


@app.command()
def plot(
    results: Annotated[
        list[Path], typer.Argument(help="Results of runs; several share axes.", metavar="RESULT.nc")
    ],
    out: Annotated[Path | None, typer.Option(help="Figure; default RESULT.png here.")] = None,
    profiles: Annotated[
        bool, typer.Option("--profiles", help="Tip and surface at twelve instants instead.")
    ] = False,
    reference: Annotated[
        list[str] | None,
        typer.Option(
            help="Known answer to draw beside: hertz, dmt, jkr, maugis, lee-radok or ting; repeat "
            "it for several.",
            metavar="NAME",
        ),
    ] = None,
    force: Force = False,
) -> None:
    """Draw one result, or several of the same mode in one figure."""
    with _report_bad_input():
        if profiles and len(results) > 1:
            raise ValueError(f"{len(results)} results with --profiles: must be one")
        if profiles and reference:
            raise ValueError(
                "--reference with --profiles: must be one of the two, as profiles show no forces"
            )
        kind = "-profiles" if profiles else ""
        out = _choose_output(out, f"{results[0].stem}{kind}.png", _PICTURES, force)

        from softafm.draw.results import plot as draw
        from softafm.draw.storyboard import plot_profiles

        datasets = [_load(path) for path in results]
        if profiles:
            figure = plot_profiles(datasets[0])
        else:
            names = [path.stem for path in results]
            figure = draw(datasets, labels=names, reference=[*reference] if reference else None)
    _save_figure(figure, out, force)


@app.command()
def animate(
    result: Result,
    out: Annotated[Path, typer.Option(help="Movie: .mp4, .gif or .html.", metavar="MOVIE.html")],
    frames: Annotated[int, typer.Option(help="Number of frames.")] = 150,
    seconds: Annotated[float, typer.Option(help="Duration of the movie.")] = 6.0,
    start: Annotated[
        str | None, typer.Option(help="Time of the run to start at, e.g. 1.5us.", metavar="TIME")
    ] = None,
    stop: Annotated[str | None, typer.Option(help="Time to end at.", metavar="TIME")] = None,
    force: Force = False,
) -> None:
    """Write a movie of tip and surface; needs a result run with --profiles."""
    with _report_bad_input():
        from softafm.draw import animation

        out = _choose_output(out, "", animation.SUFFIXES, force)
        write = partial(
            animation.animate,
            frames=frames,
            seconds=seconds,
            start=_read_time("start", start),
            stop=_read_time("stop", stop),
            progress=sys.stderr.isatty(),
        )
        try:
            _save(partial(write, _load(result)), out, force)
        except RuntimeError as error:
            raise _Failure(str(error)) from error
    typer.echo(f"saved {out}")


def _load(path: Path) -> "Dataset":
    """Read a result; ValueError or OSError if the file does not hold one."""
    from softafm.experiment.takers import refuse_other_than_result
    from softafm.results import datasets as results

    refuse_other_than_result(path)
    return results.load_apart(path)


def _read_time(option: str, written: str | None) -> float | None:
    from softafm.units.quantities import TIME, read_quantity

    try:
        return None if written is None else read_quantity(written, TIME)
    except ValueError as error:
        raise ValueError(f"--{option} = {written!r}: {error}") from None


@app.command()
def info(config: Config, overrides: Overrides = None) -> None:
    """Show the regime, the scales and the expected cost of an experiment, without running it."""
    with _report_bad_input():
        from softafm.experiment.config import load_experiment
        from softafm.experiment.regime import regime

        table = regime(load_experiment(config, overrides or []))
    _print(table)


@app.command()
def show(
    config: Config,
    out: Annotated[Path | None, typer.Option(help="Figure; default CONFIG-contact.png.")] = None,
    overrides: Overrides = None,
    force: Force = False,
) -> None:
    """Draw what touches in an experiment: tip, surface law and sample."""
    with _report_bad_input():
        out = _choose_output(out, f"{config.stem}-contact.png", _PICTURES, force)

        from softafm.draw.contact import plot_contact
        from softafm.experiment.config import load_experiment

        figure = plot_contact(load_experiment(config, overrides or []).contact)
    _save_figure(figure, out, force)


@app.command()
def export(
    result: Result,
    out: Annotated[
        Path, typer.Option(help="Curve (.csv), maps (.gwy) or all (.h5).", metavar="CURVE.csv")
    ],
    force: Force = False,
) -> None:
    """Write the curve of a result as text, or maps for Gwyddion, for other programs."""
    with _report_bad_input():
        out = _choose_output(out, "", (".csv", ".gwy", ".h5"), force)

        from softafm import export_gwyddion
        from softafm.results import datasets as results

        dataset = _load(result)
        write = export_gwyddion if out.suffix.lower() == ".gwy" else results.export
        try:
            _save(partial(write, dataset), out, force)
        except ImportError as error:
            raise ValueError(error) from None
    typer.echo(f"saved {out}")


@app.command()
def sweep(
    config: Annotated[
        Path | None, typer.Argument(help="Experiment with a [sweep].", metavar="CAMPAIGN.toml")
    ] = None,
    out: Annotated[
        Path | None, typer.Option(help="Store; default CAMPAIGN.zarr here.", metavar="STORE.zarr")
    ] = None,
    overrides: Overrides = None,
    workers: Annotated[int | None, typer.Option(help="Processes; default one per core.")] = None,
    scheduler: Annotated[
        str | None, typer.Option(help="Dask cluster to use instead.", metavar="tcp://HOST:PORT")
    ] = None,
    resume: Annotated[bool, typer.Option("--resume", help="Continue an earlier sweep.")] = False,
    yes: Annotated[bool, typer.Option("--yes", help="Allow any number of runs.")] = False,
    status: Annotated[
        Path | None, typer.Option(help="Show how far a sweep is.", metavar="STORE.zarr")
    ] = None,
    force: Force = False,
) -> None:
    """Run an experiment for many values of its fields, and keep their observables."""
    if (config is None) == (status is None):
        raise _BadInput("sweep: give a CAMPAIGN.toml, or --status and a store")
    with _report_bad_input():
        try:
            from softafm.sweeps import sweep as sweeps
        except ModuleNotFoundError as error:
            raise ValueError(error) from None
        from softafm.sweeps import progress

        if config is None:
            assert status is not None
            _print(progress.tabulate(progress.read_status(status)))
            return
        out = Path(f"{config.stem}.zarr") if out is None else out
        campaign, batch = sweeps.plan(config, overrides or [])
        sweeps.refuse_size(campaign, scheduler, workers, yes)
        ready = sweeps.prepare(
            campaign, out, batch=batch, scheduler=scheduler, workers=workers, resume=resume,
            force=force,
        )  # fmt: skip
    goes_on = f"finished runs are in {out}; --resume continues the sweep"
    try:
        sweeps.finish(campaign, ready, scheduler, workers, progress=sys.stderr.isatty())
    except KeyboardInterrupt:
        raise _Failure(f"interrupted; {goes_on}") from None
    except sweeps.Busy as error:
        raise _BadInput(str(error)) from None
    except sweeps.Halted as error:
        raise _Failure(f"{error}; {goes_on}") from None
    except OSError as error:
        raise _Failure(
            f"{out} could not be written: {error.strerror or error}; {goes_on}"
        ) from None
    found = progress.read_status(out)
    if found.failed:
        example = f"{found.failed} of {found.runs} runs failed: {found.example}"
        print(f"softafm: warning: {example}", file=sys.stderr)
    _print(progress.tabulate(found))
    typer.echo(f"saved {out}")


@app.command(name="app")
def page(
    port: Annotated[int | None, typer.Option(help="Port; default 5006, or any free one.")] = None,
    address: Annotated[str, typer.Option(help="Where to listen; 0.0.0.0 is everywhere.")] = (
        "127.0.0.1"
    ),
    origin: Annotated[
        list[str] | None, typer.Option(help="HOST:PORT by which browsers reach the page.")
    ] = None,
    browser: Annotated[bool, typer.Option(help="Open the page in the browser.")] = True,
    processes: Annotated[int, typer.Option(help="Runs at the same time.")] = 1,
    waiting: Annotated[int, typer.Option(help="Runs of one user that may wait.")] = 4,
    listed: Annotated[int, typer.Option(help="Runs that one user may keep.")] = 20,
    run_limit: Annotated[str, typer.Option(help="Longest run.", metavar="TIME")] = "600 s",
    upload_limit: Annotated[float, typer.Option(help="Largest file, MB.", metavar="MB")] = 20.0,
    memory_limit: Annotated[
        float, typer.Option(help="Memory for results of one user, MB.", metavar="MB")
    ] = 500.0,
) -> None:
    """Open the web page: forms, plots and surface movies; needs softafm\\[app]."""
    with _report_bad_input():
        try:
            from softafm.app.limits import Limits
            from softafm.app.server import serve
        except ModuleNotFoundError as error:
            raise ValueError(
                f"the page needs the package '{error.name}': pip install 'softafm[app]'"
            ) from None
        limits = Limits(
            processes=processes,
            waiting=waiting,
            listed=listed,
            run_seconds=_read_time("run-limit", run_limit) or 0.0,
            upload_bytes=int(1e6 * upload_limit),
            kept_bytes=int(1e6 * memory_limit),
        )
        serve(limits, address, port, tuple(origin or ()), browser)


def _complain(text: str, code: int) -> int:
    for line in text.splitlines():
        print(f"softafm: {line}", file=sys.stderr)
    return code


def _report_interruption() -> int:
    return _complain("interrupted, nothing written", FAILURE)


@contextmanager
def _report_bad_input() -> Iterator[None]:
    """Report what is refused inside as bad input, and what is warned of in one line each.

    A run does not belong inside.
    """
    try:
        with _show_warnings():
            yield
    except (ValueError, OSError) as error:
        raise _BadInput(str(error)) from error


def _choose_output(out: Path | None, default: str, suffixes: tuple[str, ...], force: bool) -> Path:
    """Return where to write, having made sure that it can be written; OSError or ValueError."""
    path = Path(default) if out is None else out
    if path.suffix.lower() not in suffixes:
        raise ValueError(f"--out = {path}: must end in {' or '.join(suffixes)}")
    if path.exists() and not path.is_file():
        raise ValueError(f"--out = {path}: exists and is not a file")
    if os.path.lexists(path) and not force:
        raise ValueError(f"--out = {path}: exists; choose another name or add --force")
    if path.exists() and not os.access(path, os.W_OK):
        raise ValueError(f"--out = {path}: is write-protected")
    try:
        with tempfile.TemporaryFile(dir=path.parent):
            pass
    except OSError as error:
        raise ValueError(f"--out = {path}: cannot write there: {error.strerror}") from None
    return path


def _save(write: Callable, out: Path, force: bool) -> None:
    """Let ``write`` make the output, as ``results.save`` does."""
    try:
        write(out, overwrite=force)
    except FileExistsError:
        raise _BadInput(f"--out = {out}: appeared meanwhile; add --force to overwrite") from None
    except OSError as error:
        raise _Failure(f"{out} could not be written: {error.strerror or error}") from error


def _save_content(content: bytes, out: Path, force: bool) -> None:
    from softafm.results.datasets import write_whole

    def write(path: Path, *, overwrite: bool) -> None:
        write_whole(path, overwrite, lambda part: Path(part).write_bytes(content))

    _save(write, out, force)


def _save_figure(figure: "Figure", out: Path, force: bool) -> None:
    picture = io.BytesIO()
    figure.savefig(picture, format=out.suffix[1:].lower(), dpi=150)
    _save_content(picture.getvalue(), out, force)
    typer.echo(f"saved {out}")


def _print(renderable) -> None:
    from rich.console import Console

    Console().print(renderable)


@contextmanager
def _show_progress() -> Iterator[Callable[[float, str], None]]:
    """Yield a function for a run to report progress to: a bar on a terminal. Ctrl-C ends a run."""
    from softafm.progress import make_reporter

    with _heed_interrupts() as heed, make_reporter(sys.stderr.isatty()) as report:

        def progress(fraction: float, message: str) -> None:
            heed()
            if report is not None:
                report(fraction, message)

        yield progress


@contextmanager
def _heed_interrupts() -> Iterator[Callable[[], None]]:
    """Yield what a run must call now and then, for Ctrl-C to end it without fail.

    While arguments enter compiled code, numba loses a KeyboardInterrupt or turns it into another
    error, so Ctrl-C is noted as well as raised.
    """
    pressed = False

    def press(number, frame):
        nonlocal pressed
        pressed = True
        raise KeyboardInterrupt

    def heed() -> None:
        if pressed:
            raise KeyboardInterrupt

    ours = signal.getsignal(signal.SIGINT) is signal.default_int_handler
    ours = ours and threading.current_thread() is threading.main_thread()
    if ours:
        signal.signal(signal.SIGINT, press)
    try:
        yield heed
    except Exception:
        heed()
        raise
    finally:
        if ours:
            signal.signal(signal.SIGINT, signal.default_int_handler)


@contextmanager
def _show_warnings() -> Iterator[None]:
    """Print warnings about input and result as one line each, once; leave others as they are."""
    with warnings.catch_warnings():
        warnings.simplefilter("always", AccuracyWarning)
        warnings.simplefilter("default", DoubtfulValueWarning)
        usual, printed = warnings.showwarning, set()

        def show(message, category, *place, **options):
            if issubclass(category, AccuracyWarning | DoubtfulValueWarning):
                text = " ".join(str(message).split())
                if text not in printed:
                    print(f"softafm: warning: {text}", file=sys.stderr)
                printed.add(text)
            else:
                usual(message, category, *place, **options)

        warnings.showwarning = show
        yield


if __name__ == "__main__":
    sys.exit(main())
