"""``softafm app``: the page as a server, on this machine or for others."""

import threading
import webbrowser
from typing import Any

import panel as pn

from softafm.app.limits import Limits
from softafm.app.page import Page, resource
from softafm.app.runs import Runner

_PORT = 5006


def serve(
    limits: Limits,
    address: str = "127.0.0.1",
    port: int | None = None,
    origins: tuple[str, ...] = (),
    show: bool = True,
) -> None:
    """Serve the page until interrupted.

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
    runner = Runner(limits.processes, limits.waiting, limits.run_seconds)
    server = _server(runner, limits, address, port, origins)
    with runner:
        server.start()
        url = f"http://{'127.0.0.1' if address == '0.0.0.0' else address}:{server.port}/"
        print(f"softafm: the page is at {url} (Ctrl-C ends it)", flush=True)
        if show:
            threading.Thread(target=webbrowser.open, args=(url,), daemon=True).start()
        try:
            server.io_loop.start()
        finally:
            server.stop()
            print("softafm: the page is closed", flush=True)


def page(runner: Runner, limits: Limits) -> Page:
    """Return a page for one more user, who takes its runs along when leaving."""
    one = Page(runner, limits)
    pn.state.on_session_destroyed(lambda _: one.close())
    return one


def _server(
    runner: Runner, limits: Limits, address: str, port: int | None, origins: tuple[str, ...]
) -> Any:
    """Return a server that listens but does not serve yet."""
    if port is not None and not 0 <= port <= 65535:
        raise ValueError(f"--port = {port}: must be between 0 and 65535")
    try:
        return pn.serve(
            {"/": lambda: page(runner, limits)},
            address=address,
            port=_PORT if port is None else port,
            title="softafm",
            show=False,
            start=False,
            websocket_origin=list(origins) or None,
            websocket_max_message_size=int(1.4 * limits.upload_bytes) + 1_000_000,
            autoreload=False,
            admin=False,
            verbose=False,
        )
    except OSError as error:
        if port is None:
            return _server(runner, limits, address, 0, origins)
        reason = error.strerror or error
        raise ValueError(f"--address = {address}, --port = {port}: {reason}") from None


pn.config.raw_css = [*pn.config.raw_css, resource("whole.css")]
