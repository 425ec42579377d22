"""Chromium without a window, for tests of pages: commands of the DevTools protocol over a pipe."""

import base64
import contextlib
import itertools
import json
import os
import select
import shutil
import subprocess
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Self

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--hide-scrollbars",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-dev-shm-usage",
    "--no-first-run",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
)
TIMEOUT = 60.0  # of a command [s]


def find_chromium() -> str | None:
    """Return the program, or None where there is none."""
    return next((found for name in NAMES if (found := shutil.which(name))), None)


class Browser:
    """One page of a browser, its messages and its requests."""

    def __init__(self, program: str, profile: Path) -> None:
        # The browser reads commands from its file descriptor 3 and answers on 4.
        command_read, self._write = os.pipe()
        self._read, answer_write = os.pipe()

        def place() -> None:
            os.dup2(command_read, 3)
            os.dup2(answer_write, 4)

        low, high = os.dup(command_read), os.dup(answer_write)
        self._process = subprocess.Popen(
            [program, *FLAGS, "--remote-debugging-pipe", f"--user-data-dir={profile}", "about:blank"],
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            pass_fds=(3, 4),
            preexec_fn=place,
        )
        for descriptor in (command_read, answer_write, low, high):
            os.close(descriptor)
        self._numbers, self._buffer = itertools.count(1), b""
        self.events: list[dict[str, Any]] = []
        target = self._call("Target.createTarget", {"url": "about:blank"})["targetId"]
        self._session = self._call("Target.attachToTarget", {"targetId": target, "flatten": True})["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *problem: object) -> None:
        with contextlib.suppress(OSError):
            self._call("Browser.close", {})
        try:
            self._process.wait(10.0)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        os.close(self._write)
        os.close(self._read)

    def call(self, method: str, **parameters: Any) -> dict[str, Any]:
        """Send a command to the page and return its answer."""
        return self._call(method, parameters, self._session)

    def _call(self, method: str, parameters: dict[str, Any], session: str | None = None) -> dict[str, Any]:
        number = next(self._numbers)
        message = {"id": number, "method": method, "params": parameters}
        message |= {"sessionId": session} if session else {}
        os.write(self._write, json.dumps(message).encode() + b"\0")
        for answer in self._answers(TIMEOUT):
            if answer.get("id") == number:
                if "error" in answer:
                    raise AssertionError(f"{method}: {answer['error']}")
                return dict(answer["result"])
            self.events.append(answer)
        raise AssertionError(f"{method}: no answer in {TIMEOUT:g} s")

    def _answers(self, seconds: float) -> Iterator[dict[str, Any]]:
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0.0:
            while b"\0" in self._buffer:
                text, _, self._buffer = self._buffer.partition(b"\0")
                yield json.loads(text)
            if select.select([self._read], [], [], left)[0]:
                piece = os.read(self._read, 1 << 20)
                if not piece:
                    raise OSError("the browser has closed its end")
                self._buffer += piece

    def open(self, path: Path, fragment: str = "") -> float:
        """Open a file and return how long it took to load [s]; messages and requests of before are forgotten."""
        self.events.clear()
        begin = time.monotonic()
        self.call("Page.navigate", url=path.as_uri() + fragment)
        for _ in range(2):  # Page.navigate answers at once, and evaluation waits for the new document.
            self.wait_for("document.readyState === 'complete'")
        return time.monotonic() - begin

    def value(self, expression: str) -> Any:
        """Evaluate an expression in the page, after its promises."""
        found = self.call("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def wait_for(self, expression: str, seconds: float = 60.0) -> None:
        """Wait until an expression is true."""
        end = time.monotonic() + seconds
        while not self.value(f"Boolean({expression})"):
            assert time.monotonic() < end, f"never true: {expression}"
            time.sleep(0.05)

    def wait_for_event(self, method: str) -> None:
        """Wait until the page tells of an event, without asking it anything meanwhile."""
        if any(event.get("method") == method for event in self.events):
            return
        for answer in self._answers(TIMEOUT):
            self.events.append(answer)
            if answer.get("method") == method:
                return
        raise AssertionError(f"{method}: not in {TIMEOUT:g} s")

    def resize(self, width: int, height: int = 900, *, dark: bool = False, media: str = "") -> None:
        """Set the size of the page and its colours."""
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)
        features = [{"name": "prefers-color-scheme", "value": "dark" if dark else "light"}]
        self.call("Emulation.setEmulatedMedia", media=media, features=features)

    def screenshot(self, selector: str = "") -> bytes:
        """Return a picture of what is in sight, or of an element, as PNG."""
        more = {}
        if selector:
            box = self.value(
                f"(() => {{ const r = document.querySelector({json.dumps(selector)}).getBoundingClientRect();"
                " return {x: r.x + scrollX, y: r.y + scrollY, width: r.width, height: r.height, scale: 1}; })()"
            )
            more = {"clip": box}
        return base64.b64decode(self.call("Page.captureScreenshot", format="png", **more)["data"])

    def printed(self) -> bytes:
        """Return the page as PDF."""
        return base64.b64decode(self.call("Page.printToPDF", preferCSSPageSize=True, printBackground=False)["data"])

    def problems(self) -> list[str]:
        """Return errors and warnings of the page's console and what its policy refused."""
        self.value("new Promise((done) => setTimeout(done, 50))")
        found = []
        for event in self.events:
            given = event.get("params", {})
            if event.get("method") == "Runtime.exceptionThrown":
                found.append(str(given["exceptionDetails"]))
            elif event.get("method") == "Runtime.consoleAPICalled" and given["type"] in ("error", "warning"):
                found.append(" ".join(str(one.get("value", one.get("description"))) for one in given["args"]))
            elif event.get("method") == "Log.entryAdded" and given["entry"]["level"] in ("error", "warning"):
                found.append(given["entry"]["text"])
        # The viewer of shapes says so where a busy processor draws too slowly.
        return [one for one in found if "rAF timed out" not in one]

    def requests(self) -> list[str]:
        """Return the addresses that the page asked for, but for itself and data inside it."""
        asked = [
            event["params"]["request"]["url"]
            for event in self.events
            if event.get("method") == "Network.requestWillBeSent"
        ]
        return [url for url in asked if not url.startswith(("data:", "blob:", "file:"))]
