"""The server of the lab: this machine only, a free port, until Ctrl-C."""

from __future__ import annotations

import logging
import signal
import socket
import webbrowser
from collections.abc import Callable
from typing import Any

from ..errors import InputError
from .setup import Setup

HOST = "127.0.0.1"


def serve(scene: str, port: int, browser: bool, tell: Callable[[str], None]) -> None:
    """Serve pages that begin with a scene, until Ctrl-C or SIGTERM; `tell` gets the address.

    Raises:
        InputError: The scene is none, the extra is not installed, or the port is taken.
    """
    start = Setup.of_scene(scene)
    if start.refusal:
        raise InputError(f"{scene}: {start.refusal}")
    try:
        import panel
        import tomli_w  # noqa: F401
    except ImportError:
        raise InputError("lab: Panel and Bokeh are not installed; run: pip install 'kinsim[lab]'") from None
    from .view.page import Page

    panel.extension()
    logging.getLogger("bokeh").setLevel(logging.ERROR)  # a tab that is closed while it is drawn is no event
    logging.getLogger("asyncio").addFilter(_matters)
    port = _free(port)
    server: Any = panel.io.server.get_server(
        {"/": lambda: Page(start).template()}, port=port, address=HOST, websocket_origin=[f"{HOST}:{port}"],
        title="kinsim lab", show=False, start=False,
    )  # fmt: skip
    server.start()
    address = f"http://{HOST}:{port}/"
    tell(address)
    loop = server.io_loop
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: loop.add_callback_from_signal(loop.stop))
    if browser:
        loop.call_later(0.2, webbrowser.open, address)
    loop.start()
    server.stop()


def _matters(record: logging.LogRecord) -> bool:
    """Whether it is more than a picture that found its tab closed."""
    from tornado.websocket import WebSocketClosedError

    return not (record.exc_info and isinstance(record.exc_info[1], WebSocketClosedError))


def _free(port: int) -> int:
    """`port`, or a free one for 0."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except (OSError, OverflowError):
            raise InputError(f"lab: port {port} cannot be used; leave out --port to take a free one") from None
        return int(probe.getsockname()[1])
