"""Chromium without a window, driven by its DevTools protocol over two pipes."""

import base64
import json
import os
import shutil
import subprocess
from contextlib import suppress
from select import select
from time import monotonic

# Without a graphics card, a sandbox, or a word to anybody.
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--disable-gpu",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)


def chromium():
    """The browser's program, or None."""
    return shutil.which("chromium") or shutil.which("chromium-browser")


class Browser:
    """One page of a browser; `size` is the window's in CSS pixels."""

    def __init__(self, folder, size=(800, 450), flags=FLAGS):
        to_child, self._out = os.pipe()
        self._in, from_child = os.pipe()
        width, height = size

        def as_pipes():
            # The protocol has the descriptors 3 and 4; either may be taken by the other one.
            spare = [os.dup(to_child), os.dup(from_child)]
            high = [os.dup2(one, 60 + k) for k, one in enumerate(spare)]
            for number, one in zip((3, 4), high, strict=True):
                os.dup2(one, number)

        self._process = subprocess.Popen(
            [
                chromium(),
                *flags,
                f"--window-size={width},{height}",
                f"--user-data-dir={folder}",
                "--remote-debugging-pipe",
            ],
            preexec_fn=as_pipes,
            close_fds=False,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(to_child)
        os.close(from_child)
        self._read = b""
        self._number = 0
        self._session = None
        self.errors = []
        page = self._call("Target.createTarget", url="about:blank")["targetId"]
        found = self._call("Target.attachToTarget", targetId=page, flatten=True)
        self._session = found["sessionId"]
        self._call("Runtime.enable")
        self._call("Page.enable")
        self.resize(*size)

    def resize(self, width, height, mobile=False):
        """Lay the page out anew."""
        self._call(
            "Emulation.setDeviceMetricsOverride",
            width=width,
            height=height,
            deviceScaleFactor=1,
            mobile=mobile,
        )

    def open(self, address):
        """Open a shared page, up to its first picture."""
        self._call("Page.navigate", url=address)
        self.until("document.body?.className === 'ready'")

    def value(self, script, seconds=120.0):
        """The value of an expression; a promise is awaited."""
        found = self._call(
            "Runtime.evaluate",
            seconds,
            expression=script,
            awaitPromise=True,
            returnByValue=True,
        )
        assert "exceptionDetails" not in found, found["exceptionDetails"]
        return found["result"].get("value")

    def until(self, script, seconds=120.0):
        """Wait until an expression is true."""
        end = monotonic() + seconds
        while not self.value(script):
            assert monotonic() < end, f"{script} in {seconds} s; {self.errors}"

    def screenshot(self):
        """The page as PNG."""
        return base64.b64decode(self._call("Page.captureScreenshot", format="png")["data"])

    def close(self):
        """End the browser."""
        with suppress(OSError):
            os.close(self._out)
        self._process.terminate()
        self._process.wait(20)
        os.close(self._in)

    def _call(self, method, seconds=120.0, **parameters):
        self._number += 1
        message = {"id": self._number, "method": method, "params": parameters}
        if self._session is not None:
            message["sessionId"] = self._session
        os.write(self._out, json.dumps(message).encode() + b"\0")
        end = monotonic() + seconds
        while True:
            answer = self._next(end, method)
            if answer.get("method") == "Runtime.exceptionThrown":
                self.errors.append(answer["params"]["exceptionDetails"])
            if answer.get("id") == self._number:
                assert "error" not in answer, answer
                return answer["result"]

    def _next(self, end, method):
        while b"\0" not in self._read:
            ready, _, _ = select([self._in], [], [], max(end - monotonic(), 0.0))
            assert ready, f"{method} in time"
            part = os.read(self._in, 1 << 20)
            assert part, f"the browser ended at {method}"
            self._read += part
        answer, self._read = self._read.split(b"\0", 1)
        return json.loads(answer)
