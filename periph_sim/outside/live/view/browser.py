"""Display of a session as a web page, for browsers on this computer. The page shows the snapshots of a `Board`.

    GET /        the page
    GET /events  snapshots as server-sent events, one for each new snapshot that the client is fast enough to receive

The server has its own threads, which only read the board. By default it listens on the loopback address. It then
answers only requests that address this computer by a local name, so that pages of other sites cannot read the display.

Source: WHATWG HTML, section 9.2, server-sent events.
"""

from __future__ import annotations

import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import cast

from ...errors import OutsideError
from .status import Board

PAGE = Path(__file__).with_name("page.html")
LOOPBACK = "127.0.0.1"
OURS = ("127.0.0.1", "localhost", "[::1]")
END_SEEN = 0.05  # interval in seconds at which the server checks whether it must stop
RULES = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'; connect-src 'self'; img-src data:"


class Browser:
    """Server of the page, in its own thread. url: the page's address. Raise OutsideError if it cannot listen."""

    def __init__(self, board: Board, port: int, address: str = LOOPBACK) -> None:
        try:
            self._server = _Server((address, port), _Handler)
        except (OSError, OverflowError) as error:
            what = getattr(error, "strerror", None) or error
            raise OutsideError(f"port {port} of {address}: {what}; give another one") from None
        self._server.board = board
        self._server.guarded = address == LOOPBACK
        self.url = "http://{}:{}/".format(*self._server.server_address[:2])
        self._thread = threading.Thread(target=self._server.serve_forever, args=(END_SEEN,), daemon=True)
        self._thread.start()

    def close(self) -> None:
        """Stop the server. Call this after the board is closed, so that clients receive the last snapshot."""
        self._server.shutdown()
        self._server.server_close()
        self._thread.join()


class _Server(ThreadingHTTPServer):
    board: Board
    guarded: bool
    daemon_threads = False  # `server_close` waits for the threads, which end when the board is closed


class _Handler(BaseHTTPRequestHandler):
    server_version, sys_version = "periph-sim", ""
    timeout = 10  # maximum time in seconds that a client may take for its request

    def do_GET(self) -> None:
        server = cast(_Server, self.server)
        host = self.headers.get("Host", "").rpartition(":")[0] or self.headers.get("Host", "")
        if server.guarded and host not in OURS:
            self.send_error(403, "this page is for this computer only")
        elif self.path == "/":
            self._page()
        elif self.path == "/events":
            self._events(server.board)
        else:
            self.send_error(404)

    def _begin(self, headers: dict[str, str]) -> None:
        self.send_response(200)
        for name, value in headers.items():
            self.send_header(name, value)
        self.end_headers()

    def _page(self) -> None:
        data = PAGE.read_bytes()
        length = {"Content-Length": str(len(data)), "Content-Security-Policy": RULES}
        self._begin({"Content-Type": "text/html; charset=utf-8", **length})
        self.wfile.write(data)

    def _events(self, board: Board) -> None:
        self._begin({"Content-Type": "text/event-stream", "Cache-Control": "no-store"})
        try:
            for snapshot in board.snapshots():
                event = ": still here" if snapshot is None else f"data: {json.dumps(snapshot)}"
                self.wfile.write(f"{event}\n\n".encode())
                self.wfile.flush()
        except OSError:
            return  # the client has disconnected

    def log_message(self, format: str, *arguments: object) -> None:
        """Do nothing, because requests are not logged."""
