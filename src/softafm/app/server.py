"""``softafm app``: the page as a server, on this machine or for others."""

import signal
import threading
import webbrowser
from contextlib import suppress
from errno import EADDRINUSE
from typing import Any

import panel as pn
from panel.io.resources import LOCAL_DIST

from softafm.app.limits import Limits
from softafm.app.page import Page, read_resource
from softafm.app.runs import Runner

_PORT = 5006
_ABANDONED = 5000
"""Time after which a page that nobody looks at any more is forgotten, with its runs, ms."""


def serve(
    limits: Limits,
    address: str = "127.0.0.1",
    port: int | None = None,
    origins: tuple[str, ...] = (),
    show: bool = True,
) -> None:
    """Serve the page until interrupted, or told to terminate.

    Parameters
    ----------
    limits
        What each user may ask for.
    address, port
        Where to listen; without a port at 5006, or any free one if that is taken.
    origins
        Names under which browsers reach the server, ``host:port``, if not by ``address``.
    show
        Open the page in the user's browser.

    Raises
    ------
    ValueError
        If the port is taken or the address not ours.
    """
    runner = Runner(limits.processes, limits.waiting, limits.run_seconds, limits.kept_bytes)
    server = _make_server(runner, limits, address, port, origins)
    with runner:
        server.start()
        url = f"http://{'127.0.0.1' if address == '0.0.0.0' else address}:{server.port}/"
        print(f"softafm: the page is at {url} (Ctrl-C ends it)", flush=True)
        if show:
            threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        try:
            with suppress(KeyboardInterrupt):
                server.io_loop.start()
        finally:
            server.stop()
            print("softafm: the page is closed", flush=True)


def make_page(runner: Runner, limits: Limits) -> Page:
    """Return a page for one more user, who takes its runs along when leaving."""
    # Otherwise Panel asks an outside address for the styles of what it draws later.
    pn.state.curdoc.template_variables["dist_url"] = LOCAL_DIST
    one = Page(runner, limits)
    pn.state.on_session_destroyed(lambda _: one.close())
    return one


def _make_server(
    runner: Runner, limits: Limits, address: str, port: int | None, origins: tuple[str, ...]
) -> Any:
    """Return a server that listens but does not serve yet."""
    if port is not None and not 0 <= port <= 65535:
        raise ValueError(f"--port = {port}: must be between 0 and 65535")
    try:
        return pn.serve(
            {"/": lambda: make_page(runner, limits)},
            address=address,
            port=_PORT if port is None else port,
            title="softafm",
            show=False,
            start=False,
            websocket_origin=list(origins) or None,
            websocket_max_message_size=int(1.4 * limits.upload_bytes) + 1_000_000,
            check_unused_sessions_milliseconds=1000,
            unused_session_lifetime_milliseconds=_ABANDONED,
            autoreload=False,
            admin=False,
            verbose=False,
        )
    except OSError as error:
        if port is None and error.errno == EADDRINUSE:
            return _make_server(runner, limits, address, 0, origins)
        asked = f"--address = {address}" + ("" if port is None else f", --port = {port}")
        raise ValueError(f"{asked}: {error.strerror or error}") from None


pn.config.raw_css = [*pn.config.raw_css, read_resource("frame.css"), read_resource("whole.css")]
