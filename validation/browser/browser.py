"""Headless Chromium, driven by the DevTools protocol over pipes: opens a page, inspects it, and records errors."""

import base64
import functools
import json
import os
import pathlib
import shutil
import subprocess
import tempfile
import time

NAMES = ("chromium", "chromium-browser", "google-chrome")
# WebGL in software: test machines have no graphics card.
OPTIONS = ["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--no-first-run"]
PATIENCE = 120


@functools.cache
def program():
    """Path of the browser, or `None`."""
    return next(filter(None, map(shutil.which, NAMES)), None)


class Browser:
    """A browser with one page of a given size."""

    def __init__(self, width=1180, height=900):
        self.profile = tempfile.TemporaryDirectory()
        (theirs_in, self.out), (self.into, theirs_out) = os.pipe(), os.pipe()

        def give_pipes():
            """Connects the pipes: the browser reads from descriptor 3 and writes to descriptor 4."""
            spare = [os.dup(theirs_in), os.dup(theirs_out)]
            os.dup2(spare[0], 3)
            os.dup2(spare[1], 4)

        command = [program(), *OPTIONS, f"--window-size={width},{height}", "--remote-debugging-pipe"]
        command += [f"--user-data-dir={self.profile.name}", "about:blank"]
        quiet = subprocess.DEVNULL
        self.process = subprocess.Popen(command, preexec_fn=give_pipes, close_fds=False, stdout=quiet, stderr=quiet)
        os.close(theirs_in)
        os.close(theirs_out)
        self.number, self.session, self.waiting, self.events = 0, None, b"", []
        self.attach(width, height)

    def attach(self, width, height):
        target = self.call("Target.createTarget", url="about:blank")["targetId"]
        self.session = self.call("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.call(f"{domain}.enable")
        # Pictures of pages longer than the window would otherwise include the width of the scroll bar.
        self.call("Emulation.setScrollbarsHidden", hidden=True)
        self.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1, mobile=False)

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.terminate()
        self.process.wait(PATIENCE)
        os.close(self.out)
        os.close(self.into)
        self.profile.cleanup()

    def message(self):
        """The next message of the browser."""
        while b"\0" not in self.waiting:
            more = os.read(self.into, 1 << 20)
            if not more:
                raise RuntimeError("the browser has ended")
            self.waiting += more
        first, self.waiting = self.waiting.split(b"\0", 1)
        return json.loads(first)

    def call(self, method, **parameters):
        """The answer to a command; events in the meantime are recorded."""
        self.number += 1
        message = {"id": self.number, "method": method, "params": parameters}
        if self.session:
            message["sessionId"] = self.session
        os.write(self.out, json.dumps(message).encode() + b"\0")
        while True:
            answer = self.message()
            if answer.get("id") == self.number:
                break
            self.events.append(answer)
        if "error" in answer:
            raise RuntimeError(f"{method}: {answer['error']['message']}")
        return answer["result"]

    def open(self, path):
        """Opens a local page and waits until it is loaded."""
        self.events.clear()
        self.call("Page.navigate", url=pathlib.Path(path).resolve().as_uri())
        self.until("document.readyState === 'complete'")

    def value(self, expression):
        """Value of an expression on the page."""
        answer = self.call("Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True)
        if "exceptionDetails" in answer:
            raise RuntimeError(f"{expression}: {answer['exceptionDetails']}")
        return answer["result"].get("value")

    def until(self, expression):
        """Waits until an expression is true on the page."""
        end = time.monotonic() + PATIENCE
        while not self.value(expression):
            if time.monotonic() > end:
                raise RuntimeError(f"waited {PATIENCE} s for {expression}")
            time.sleep(0.02)

    def press(self, key):
        """Presses and releases a key."""
        for kind in ("keyDown", "keyUp"):
            text = {"text": key} if len(key) == 1 and kind == "keyDown" else {}
            self.call("Input.dispatchKeyEvent", type=kind, key=key, **text)

    def choose(self, colouring):
        """Selects a colouring of the player; returns whether it exists."""
        find = f"[...list.options].findIndex(option => option.text === {json.dumps(colouring)})"
        pick = f"if (place >= 0) {{ list.value = place; list.dispatchEvent(new Event('change')) }} return place >= 0"
        return self.value(f"(list => {{ const place = {find}; {pick} }})(document.getElementById('colouring'))")

    def picture(self, path, element=None):
        """A PNG of the visible page, or of an element."""
        # Two frames, so that the last drawing is visible.
        self.value("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))")
        clip = {"clip": {**self.place(element), "scale": 1}} if element else {}
        shot = self.call("Page.captureScreenshot", format="png", captureBeyondViewport=bool(element), **clip)
        pathlib.Path(path).write_bytes(base64.b64decode(shot["data"]))
        return path

    def place(self, element):
        """Position and size of an element on the page."""
        corner = f"const r = document.querySelector({json.dumps(element)}).getBoundingClientRect();"
        sizes = "return {x: r.x + scrollX, y: r.y + scrollY, width: r.width, height: r.height}"
        return self.value(f"(() => {{ {corner} {sizes} }})()")

    def complaints(self):
        """Errors and warnings in the console, and exceptions."""
        of = {
            "Runtime.exceptionThrown": lambda p: p["exceptionDetails"],
            "Runtime.consoleAPICalled": lambda p: p if p["type"] in ("error", "warning", "assert") else None,
            "Log.entryAdded": lambda p: p["entry"] if p["entry"]["level"] in ("error", "warning") else None,
        }
        found = [of[event["method"]](event["params"]) for event in self.events if event.get("method") in of]
        return [what for what in found if what]

    def requests(self):
        """Addresses that the page asked for."""
        sent = [event["params"] for event in self.events if event.get("method") == "Network.requestWillBeSent"]
        return [one["request"]["url"] for one in sent]
