"""The server of the page: files of the page, and replies to its requests, on this machine only.

A reply is a JSON object, followed by arrays of numbers in binary form, which the page can draw
without parsing text. Requests are answered one at a time, since a solve uses one processor.
"""

import json
import secrets
import sys
import threading
import webbrowser
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass, field
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np

from contact.errors import SceneError
from contact.explorer.session import Given, Session
from sie import Array

__all__ = ["ADDRESS", "Given", "Page"]

ADDRESS = "127.0.0.1"
_FILES = Path(__file__).with_name("web")
_TYPES = {".html": "text/html", ".css": "text/css", ".js": "text/javascript"}
# The page may load files from this server, and nothing else.
_POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; img-src data:"
)
# Number of browser tabs whose scenes the server keeps. Beyond this number the oldest scene is
# dropped, and its page starts again from the first scene.
_MAX_SESSIONS = 64


class Page:
    """A page with sliders, served until `close()` or the end of the process.

    Parameters
    ----------
    address : str
        The page's address on this machine.
    """

    def __init__(self, given: Given, tol: float, port: int | None = None) -> None:
        try:
            self._server = _Server((ADDRESS, port or 0), _Handler)
        except OSError as error:
            raise SceneError.of("port", port, f"a free port ({error.strerror or error})") from error
        self._server.given, self._server.tol = given, tol
        self.address = f"http://{ADDRESS}:{self._server.server_port}/"
        self._thread = threading.Thread(target=self._server.serve_forever, daemon=True)
        self._thread.start()

    def show(self) -> None:
        """Open the page in a browser."""
        webbrowser.open(self.address)

    def wait(self) -> None:
        """Wait until the page is closed; Ctrl-C raises KeyboardInterrupt."""
        while self._thread.is_alive():
            self._thread.join(1.0)

    def close(self) -> None:
        """Stop the server."""
        self._server.shutdown()
        self._server.server_close()

    def _repr_html_(self) -> str:
        style = "width: 100%; height: 1100px; border: 0"
        return f'<iframe src="{self.address}" title="contact" style="{style}"></iframe>'


class _Server(ThreadingHTTPServer):
    """The web server of the page, with the scenes of all browser tabs.
    It solves one request at a time.
    """

    given: Given
    tol: float
    daemon_threads = True

    def __init__(self, *given: Any) -> None:
        super().__init__(*given)
        self.sessions: OrderedDict[str, Session] = OrderedDict()
        self.lock = threading.Lock()
        self.waiting = 0
        self._count = threading.Lock()
        names = (ADDRESS, "localhost")
        self.hosts = {f"{name}:{self.server_port}" for name in names}

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Print the traceback of an error, except if the browser merely closed the connection."""
        if not isinstance(sys.exception(), ConnectionError):
            super().handle_error(request, client_address)

    def reply(self, request: Mapping[str, Any]) -> "Reply":
        """Solve what a page asks for, and return the reply to be sent to the page.

        A request for a load curve gives way to other requests, see `Session.curve`.
        """
        urgent = request.get("ask") != "curve"
        with self._count:
            self.waiting += urgent
        with self.lock:
            with self._count:
                self.waiting -= urgent
            key = str(request.get("session") or "")
            if key not in self.sessions:
                key = secrets.token_hex(8)
                self.sessions[key] = Session(self.given, self.tol, lambda: self.waiting > 0)
                while len(self.sessions) > _MAX_SESSIONS:
                    self.sessions.popitem(last=False)
                request = {**request, "ask": "begin"} if "ask" not in request else request
            self.sessions.move_to_end(key)
            header, arrays = self.sessions[key].reply(request)
        return Reply({**header, "session": key}, arrays)


@dataclass(frozen=True)
class Reply:
    """A reply of the server: a JSON object with arrays.
    As bytes it is the length of the JSON text, the text, and the arrays.

    The JSON text is padded so that arrays begin at a multiple of eight bytes.
    """

    header: Mapping[str, Any]
    arrays: Mapping[str, Array] = field(default_factory=dict)

    def __bytes__(self) -> bytes:
        shapes = {name: np.shape(values) for name, values in self.arrays.items()}
        text = json.dumps({**self.header, "arrays": shapes}, allow_nan=False).encode()
        text += b" " * (-len(text) % 8)
        parts = [np.ascontiguousarray(part, dtype="<f8") for part in self.arrays.values()]
        return b"".join([len(text).to_bytes(8, "little"), text, *(p.tobytes() for p in parts)])


class _Handler(BaseHTTPRequestHandler):
    """Handles requests of pages that this server sent.
    Requests from other web sites are refused.
    """

    server: _Server
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True
    wbufsize = -1  # a reply is sent in one piece

    def do_GET(self) -> None:
        name = self.path.partition("?")[0].lstrip("/") or "index.html"
        known = {file.name: file for file in _FILES.iterdir() if file.suffix in _TYPES}
        if not self._is_own():
            self._send(403, b"this page is for this machine only", "text/plain")
        elif name not in known:
            self._send(404, b"there is no such file", "text/plain")
        else:
            kind = f"{_TYPES[known[name].suffix]}; charset=utf-8"
            self._send(200, known[name].read_bytes(), kind)

    def do_POST(self) -> None:
        length = int(self.headers.get("Content-Length") or 0)
        body = self.rfile.read(length)
        origin = self.headers.get("Origin", "").removeprefix("http://")
        if not self._is_own() or origin not in self.server.hosts:
            self._send(403, b"only the page itself may ask", "text/plain")
            return
        try:
            request = json.loads(body)
        except ValueError:
            self._send(400, b"not JSON", "text/plain")
            return
        self._send(200, bytes(self.server.reply(request)), "application/octet-stream")

    def _is_own(self) -> bool:
        # Host is the name under which the browser reached the server. Another web site can make its
        # own name lead to this machine; then Host is that name, and the request is refused.
        return self.headers.get("Host", "") in self.server.hosts

    def _send(self, status: int, body: bytes, kind: str) -> None:
        self.send_response(status)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(body)))
        self.send_header("Cache-Control", "no-store")
        self.send_header("Content-Security-Policy", _POLICY)
        self.send_header("X-Content-Type-Options", "nosniff")
        self.end_headers()
        self.wfile.write(body)
        self.wfile.flush()

    def log_message(self, *_: Any) -> None:
        """Requests are not logged."""
