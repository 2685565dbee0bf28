"""A real browser for tests: Debian's Chromium without a window.

The tests control it by its DevTools protocol. Nothing is downloaded.
"""

from __future__ import annotations

import asyncio
import base64
import contextlib
import json
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.request import Request, urlopen

from tornado.websocket import websocket_connect

CHROMIUM = next(
    (
        found
        for name in ("chromium", "chromium-browser", "google-chrome")
        if (found := shutil.which(name))
    ),
    None,
)
MISSING = "no Chromium is installed (Debian: apt-get install chromium)"

# A JavaScript function that finds elements by a selector, also within shadow roots.
_DEEP = """
function deep(wanted, root = document) {
    const found = [...root.querySelectorAll(wanted)];
    for (const one of root.querySelectorAll('*')) if (one.shadowRoot) found.push(...deep(wanted, one.shadowRoot));
    return found;
}
"""


class Page:
    """One tab of the browser.

    `requests` are the addresses that the tab asked for. `told` are the messages that web
    sockets sent to it. `faults` are the uncaught errors of its scripts.
    """

    def __init__(self, socket: Any, loop: asyncio.AbstractEventLoop) -> None:
        self._socket, self._loop, self._count = socket, loop, 0
        self.requests: list[str] = []
        self.told: list[str] = []
        self.faults: list[str] = []

    def tell(self, method: str, **params: Any) -> dict[str, Any]:
        """Send one command of the DevTools protocol; return its result."""
        self._count += 1
        self._loop.run_until_complete(
            self._send({"id": self._count, "method": method, "params": params})
        )
        while True:
            heard = json.loads(self._loop.run_until_complete(self._hear()))
            self._note(heard)
            if heard.get("id") == self._count:
                if "error" in heard:
                    raise RuntimeError(f"{method}: {heard['error']['message']}")
                return dict(heard["result"])

    async def _send(self, message: dict[str, Any]) -> None:
        await self._socket.write_message(json.dumps(message))

    async def _hear(self) -> Any:
        return await asyncio.wait_for(self._socket.read_message(), 60.0)

    def _note(self, heard: dict[str, Any]) -> None:
        params = heard.get("params", {})
        if heard.get("method") == "Network.requestWillBeSent":
            self.requests.append(params["request"]["url"])
        if heard.get("method") == "Network.webSocketCreated":
            self.requests.append(params["url"])
        if heard.get("method") == "Network.webSocketFrameReceived":
            self.told.append(params["response"]["payloadData"])
        if heard.get("method") == "Runtime.exceptionThrown":
            self.faults.append(
                params["exceptionDetails"].get("text", "")
                + str(params["exceptionDetails"].get("exception", ""))
            )

    def open(self, address: str) -> None:
        for domain in ("Network", "Page", "Runtime"):
            self.tell(f"{domain}.enable")
        self.tell("Page.navigate", url=address)

    def run(self, script: str) -> Any:
        """The value of a JavaScript expression.

        In it, `deep(selector)` lists elements, also those within shadow roots.
        """
        done = self.tell(
            "Runtime.evaluate",
            expression=f"(() => {{ {_DEEP}; return {script}; }})()",
            returnByValue=True,
            awaitPromise=True,
        )
        if "exceptionDetails" in done:
            raise RuntimeError(f"{script}: {done['exceptionDetails']}")
        return done["result"].get("value")

    def until(self, holds: Callable[[], Any], seconds: float = 60.0) -> Any:
        """Wait until `holds()` is true and return its value; TimeoutError after `seconds`."""
        end = time.monotonic() + seconds
        while not (value := holds()):
            if time.monotonic() > end:
                raise TimeoutError(
                    f"after {seconds} s: {self.run('document.body.innerText')!r}, {self.faults}"
                )
            time.sleep(0.05)
        return value

    def mouse(self, kind: str, x: float, y: float, **more: Any) -> None:
        self.tell("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def click(self, script: str, times: int = 1) -> None:
        """Click on the middle of an element, given by a JavaScript expression."""
        x, y = self.middle(script)
        for count in range(1, times + 1):
            for kind in ("mousePressed", "mouseReleased"):
                self.mouse(kind, x, y, button="left", clickCount=count)

    def drag(self, script: str, by: float, steps: int = 10) -> None:
        """Drag an element to the right by `by` pixels, from its middle."""
        x, y = self.middle(script)
        self.mouse("mousePressed", x, y, button="left", clickCount=1)
        for step in range(1, steps + 1):
            self.mouse("mouseMoved", x + by * step / steps, y, button="left", buttons=1)
        self.mouse("mouseReleased", x + by, y, button="left", clickCount=1)

    def middle(self, script: str) -> tuple[float, float]:
        self.run(f"({script}).scrollIntoView({{block: 'center'}})")
        return tuple(
            self.run(
                f"(b => [b.x + b.width / 2, b.y + b.height / 2])(({script}).getBoundingClientRect())"
            )
        )

    def type(self, text: str) -> None:
        self.tell("Input.insertText", text=text)

    def resize(self, width: int, height: int = 1000) -> None:
        """Set the size of the window in pixels, and emulate a phone's scroll bars."""
        self.tell(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=True,
        )

    def picture(self, file: Path) -> None:
        file.write_bytes(
            base64.b64decode(
                self.tell("Page.captureScreenshot", captureBeyondViewport=True)["data"]
            )
        )


@contextlib.contextmanager
def browser(width: int = 1300, height: int = 1000) -> Iterator[Page]:
    """A tab of a new browser; the browser ends with the `with` block."""
    assert CHROMIUM is not None, MISSING
    loop = asyncio.new_event_loop()
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as home:
        options = [
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--disable-extensions",
            "--disable-background-networking",
            "--disable-component-update",
            "--remote-debugging-port=0",
            # fmt: skip
            f"--window-size={width},{height}",
            f"--user-data-dir={home}",
            "about:blank",
        ]
        silent = subprocess.DEVNULL
        process = subprocess.Popen(
            [CHROMIUM, *options],
            stdin=silent,
            stdout=silent,
            stderr=silent,
            env={**os.environ, "HOME": home},
        )
        try:
            port = _port(Path(home) / "DevToolsActivePort")
            with urlopen(
                Request(f"http://127.0.0.1:{port}/json/new?about:blank", method="PUT"), timeout=30
            ) as answer:
                address = json.load(answer)["webSocketDebuggerUrl"]
            socket = loop.run_until_complete(_connect(address))
            yield Page(socket, loop)
            loop.run_until_complete(_end(socket))
        finally:
            process.terminate()
            process.wait(30)
            loop.close()


async def _connect(address: str) -> Any:
    return await websocket_connect(address, max_message_size=1 << 27)


async def _end(socket: Any) -> None:
    socket.close()


def _port(file: Path) -> int:
    """The port that the browser has chosen; wait until the browser has written it to the file."""
    end = time.monotonic() + 60.0
    while not (file.exists() and file.read_text().strip()):
        if time.monotonic() > end:
            raise TimeoutError("the browser did not start")
        time.sleep(0.05)
    return int(file.read_text().split()[0])
