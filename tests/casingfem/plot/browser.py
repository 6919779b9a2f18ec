"""A page in a real browser, headless, driven through its debugging pipe: no driver, no package."""

import base64
import fcntl
import json
import os
import shutil
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

NAMES = ("chromium", "chromium-browser", "google-chrome", "chrome-headless-shell")
SOFTWARE = ("--use-angle=swiftshader", "--enable-unsafe-swiftshader")
PATIENCE = 60.0  # seconds for one answer


def found_browser() -> str | None:
    """A browser on this machine, that of CASINGFEM_BROWSER first."""
    named = os.environ.get("CASINGFEM_BROWSER")
    return named or next((path for path in map(shutil.which, NAMES) if path), None)


class Tab:
    """One page: commands of the DevTools protocol as NUL-ended JSON over two pipes; what it complained of is kept."""

    def __init__(self, to: int, back: int) -> None:
        self.to, self.back = to, back
        self.count, self.rest, self.session = 0, b"", ""
        self.heard: list[str] = []
        target = self.send("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.send(f"{domain}.enable")

    def send(self, method: str, **parameters: object) -> dict[str, Any]:
        """A command and its answer; what the page says meanwhile is kept."""
        self.count += 1
        message = {"id": self.count, "method": method, "params": parameters}
        os.write(self.to, json.dumps(message | ({"sessionId": self.session} if self.session else {})).encode() + b"\0")
        until = time.monotonic() + PATIENCE
        while time.monotonic() < until:
            answer = self.receive()
            if answer.get("id") == self.count:
                assert "error" not in answer, (method, answer)
                return dict(answer["result"])
            self.hear(answer)
        raise TimeoutError(method)

    def receive(self) -> dict[str, Any]:
        """The next message."""
        while b"\0" not in self.rest:
            part = os.read(self.back, 1 << 16)
            assert part, "the browser has gone"
            self.rest += part
        message, self.rest = self.rest.split(b"\0", 1)
        return dict(json.loads(message))

    def hear(self, event: dict[str, Any]) -> None:
        """Keep complaints: exceptions, warnings and errors of scripts and of the browser."""
        method, what = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            self.heard.append(str(what["exceptionDetails"]))
        if method == "Runtime.consoleAPICalled" and what["type"] in ("error", "warning", "assert"):
            self.heard.append(str(what["args"]))
        if method == "Log.entryAdded" and what["entry"]["level"] == "error":
            self.heard.append(what["entry"]["text"])

    def open(self, file: Path, width: int, height: int = 900) -> None:
        """Show a file in a window of this size."""
        self.send(
            "Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=width < 500
        )
        self.send("Page.navigate", url=file.as_uri())
        self.wait("document.readyState === 'complete' && location.protocol === 'file:'")

    def run(self, script: str) -> Any:
        """The value of an expression; of a promise what it becomes."""
        found = self.send("Runtime.evaluate", expression=script, awaitPromise=True, returnByValue=True)
        assert "exceptionDetails" not in found, found
        return found["result"].get("value")

    def wait(self, condition: str, act: Callable[[], object] = lambda: None) -> None:
        """Act until an expression is true."""
        until = time.monotonic() + PATIENCE
        act()
        while not self.run(condition):
            assert time.monotonic() < until, condition
            time.sleep(0.02)
            act()

    def look(self, canvas: str) -> str:
        """What a canvas shows, after the next pictures."""
        frames = "for (let k = 0; k < 4; k++) await new Promise(requestAnimationFrame);"
        return str(self.run(f"(async () => {{ {frames} return document.querySelector('{canvas}').toDataURL(); }})()"))

    def place(self, element: str, x: float, y: float) -> tuple[float, float]:
        """Bring an element into sight; a point of it, in parts of its width and height."""
        box = self.run(
            f"(() => {{ const e = document.querySelector('{element}'); e.scrollIntoView({{block: 'center'}});"
            "const b = e.getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()"
        )
        self.run("new Promise((go) => requestAnimationFrame(() => requestAnimationFrame(() => go(true))))")  # scrolled
        return box[0] + x * box[2], box[1] + y * box[3]

    def point(self, element: str, x: float, y: float) -> tuple[float, float]:
        """Move the pointer to a point of an element, from beside it; where that is in the window."""
        at = self.place(element, x, y)
        for beside in (2.0, 0.0):
            self.mouse("mouseMoved", at[0] + beside, at[1])
        return at

    def mouse(self, kind: str, x: float, y: float, **more: object) -> None:
        """A mouse event, as a hand makes it."""
        self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, **more)

    def drag(self, element: str, by: tuple[float, float]) -> None:
        """Press in the middle of an element, pull, let go."""
        x, y = self.place(element, 0.5, 0.5)
        self.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
        for part in (0.3, 0.6, 1.0):
            self.mouse("mouseMoved", x + part * by[0], y + part * by[1], button="left", buttons=1)
        self.mouse("mouseReleased", x + by[0], y + by[1], button="left", clickCount=1)

    def picture(self) -> bytes:
        """A PNG of the window."""
        return base64.b64decode(self.send("Page.captureScreenshot")["data"])


@contextmanager
def browser(folder: Path, *, webgl: bool = True) -> Iterator[Tab]:
    """A browser that keeps its files in a folder, and one tab."""
    path = found_browser()
    assert path is not None
    to_read, to_write = os.pipe()
    back_read, back_write = os.pipe()

    def third_and_fourth() -> None:  # the browser's own places for them, whatever is there here
        ends = [fcntl.fcntl(end, fcntl.F_DUPFD, 10) for end in (to_read, back_write)]
        os.dup2(ends[0], 3)
        os.dup2(ends[1], 4)

    running = subprocess.Popen(
        [path, "--headless=new", "--no-sandbox", "--no-first-run", "--remote-debugging-pipe", "--mute-audio",
         f"--user-data-dir={folder}", *(SOFTWARE if webgl else ("--disable-3d-apis",))],
        preexec_fn=third_and_fourth, close_fds=False, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    os.close(to_read)
    os.close(back_write)
    try:
        yield Tab(to_write, back_read)
    finally:
        running.terminate()
        running.wait(timeout=20)
        os.close(to_write)
        os.close(back_read)
