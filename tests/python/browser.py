"""Test a report in a real browser without a window: `browser.py RUN.h5 REPORT.html`.

It has the title and the statistics of the file, and pictures that can be drawn. The page must not
load anything and not print anything on the console. The browser is controlled through its
debugging pipe, which needs no package.
"""

import json
import os
import subprocess
import sys
import tempfile
import time

import h5py


class Browser:
    """A headless Chromium with one page."""

    def __init__(self, arguments=()):
        self.profile = tempfile.TemporaryDirectory()
        # It reads commands from descriptor 3 and writes answers to descriptor 4.
        to_child, self.out = os.pipe()
        self.inp, from_child = os.pipe()
        command = [
            "chromium",
            "--headless=new",
            "--no-sandbox",
            "--disable-gpu",
            "--disable-dev-shm-usage",
            "--no-first-run",
            "--remote-debugging-pipe",
            f"--user-data-dir={self.profile.name}",
            "--window-size=1200,900",
            *arguments,
            "about:blank",
        ]

        def descriptors():
            a, b = os.dup(to_child), os.dup(from_child)
            os.dup2(a, 3)
            os.dup2(b, 4)

        self.child = subprocess.Popen(
            command,
            preexec_fn=descriptors,
            close_fds=False,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        os.close(to_child)
        os.close(from_child)
        self.buffer, self.number, self.events = b"", 0, []
        target = next(
            t for t in self.call("Target.getTargets")["targetInfos"] if t["type"] == "page"
        )
        self.session = None
        self.session = self.call(
            "Target.attachToTarget", targetId=target["targetId"], flatten=True
        )["sessionId"]
        for domain in ["Page", "Runtime", "Network", "Log"]:
            self.call(f"{domain}.enable")

    def message(self):
        while b"\0" not in self.buffer:
            read = os.read(self.inp, 1 << 16)
            assert read, "the browser has ended"
            self.buffer += read
        text, self.buffer = self.buffer.split(b"\0", 1)
        return json.loads(text)

    def call(self, method, **parameters):
        self.number += 1
        command = {"id": self.number, "method": method, "params": parameters}
        if getattr(self, "session", None):
            command["sessionId"] = self.session
        os.write(self.out, json.dumps(command).encode() + b"\0")
        while True:
            message = self.message()
            if message.get("id") == self.number:
                assert "error" not in message, (method, message["error"])
                return message["result"]
            self.events.append(message)

    def value(self, expression):
        answer = self.call(
            "Runtime.evaluate", expression=expression, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in answer, answer
        return answer["result"].get("value")

    def open(self, path):
        self.events.clear()
        begun = time.monotonic()
        self.call("Page.navigate", url=f"file://{os.path.abspath(path)}")
        while (
            self.value("document.readyState") != "complete"
            or self.value("document.URL") == "about:blank"
        ):
            assert time.monotonic() - begun < 60, "the page does not load"
            time.sleep(0.05)
        return self.value("performance.timing.loadEventEnd - performance.timing.navigationStart")

    def close(self):
        self.call("Browser.close")
        self.child.wait(timeout=30)


def main(run, report):
    size = os.path.getsize(report)
    assert size < 1_000_000, f"{size} bytes"
    browser = Browser()
    milliseconds = browser.open(report)
    with h5py.File(run) as file:
        title = file.attrs["title"]
        assert browser.value("document.title") == title, browser.value("document.title")
        assert browser.value("document.querySelector('h1').textContent") == title
        rows = browser.value("document.querySelector('table tbody').rows.length")
        assert rows == len(file["statistic"]), rows
    pictures = browser.value(
        "Promise.all([...document.images].map(i => i.decode().then(() => i.naturalWidth)))"
    )
    assert len(pictures) >= 4 and min(pictures) > 100, pictures
    # A hostile title would set this variable.
    assert browser.value("typeof window.stolen") == "undefined"
    assert browser.value("document.scripts.length") == 0
    browser.close()
    complaints = [
        e
        for e in browser.events
        if e["method"] in ("Runtime.consoleAPICalled", "Runtime.exceptionThrown", "Log.entryAdded")
    ]
    assert not complaints, complaints
    asked = [
        e["params"]["request"]["url"]
        for e in browser.events
        if e["method"] == "Network.requestWillBeSent"
    ]
    others = [
        url
        for url in asked
        if not url.startswith(("file://" + os.path.abspath(report), "data:", "blob:"))
    ]
    assert not others, others
    print(
f"{report}: {len(pictures)} pictures, {size} bytes, loaded in {milliseconds} ms"
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
