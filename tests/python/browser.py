"""Test a report in a real browser without a window: `browser.py RUN.h5 REPORT.html`.

What hovering and the keyboard show is compared with what h5py reads from the file. The page must
not load anything and not print anything on the console. The browser is controlled through its
debugging pipe, which needs no package.
"""

import json
import os
import re
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


def numbers(text):
    """The lines "name value" of a tooltip as numbers by name."""
    pairs = re.findall(r"^(\w+) (none|[\u2212\d.e+-]+)$", text.replace(", ", "\n"), re.M)
    return {
        name: None if value == "none" else float(value.replace("\u2212", "-"))
        for name, value in pairs
    }


def hold(told, file, row, columns):
    for name, dataset in columns.items():
        values = dataset[:]
        expected = values[row]
        assert name in told, (name, told)
        if told[name] is None:
            assert not (expected == expected and abs(expected) != float("inf")), (name, expected)
        else:
            assert told[name] == expected, (name, told[name], expected)


def main(run, report):
    size = os.path.getsize(report)
    assert size < 3_000_000, f"{size} bytes"
    browser = Browser()
    milliseconds = browser.open(report)
    with h5py.File(run) as file:
        title = file.attrs["title"]
        assert browser.value("document.title") == title, browser.value("document.title")
        assert browser.value("document.querySelector('h1').textContent") == title
        charts = browser.value(
            "[...document.querySelectorAll('.chart')].map(c => [c.parentNode.id, c.querySelectorAll('svg path').length])"
        )
        names = [name for name, _ in charts]
        assert names == [
            "displacement",
            "static",
            "survival",
            "durations",
            "sub-phases",
            "periods",
        ], names
        assert all(paths > 10 for _, paths in charts), charts
        assert browser.value("document.querySelectorAll('#statistics tbody tr').length") == len(
            file["statistic"]
        )

        quantile = file["displacement_quantile"]
        fan = {"time": file["time"], "displacement_mean": file["displacement_mean"]}
        # Hover over the middle of the chart, whichever row is nearest to it.
        browser.value("document.getElementById('displacement').scrollIntoView({block: 'center'})")
        box = browser.value(
            "(r => [r.x, r.y, r.width, r.height])(document.querySelector('#displacement .chart').getBoundingClientRect())"
        )
        x, y = box[0] + box[2] * 0.5, box[1] + box[3] * 0.5
        for dx in (0, 1):
            browser.call("Input.dispatchMouseEvent", type="mouseMoved", x=x + dx, y=y)
        time.sleep(0.3)
        tip = browser.value(
            "[...document.querySelectorAll('#displacement svg text')].map(t => t.textContent).join('\\n')"
        )
        told = numbers(tip)
        rows = [i for i, t in enumerate(file["time"][:]) if t == told.get("time")]
        assert len(rows) == 1 and 0 < rows[0] < len(file["time"]) - 1, (tip, told)
        hold(told, file, rows[0], fan)
        assert told["displacement_q95"] == quantile[4, rows[0]]

        # Use the keyboard: from the first value to the fourth, then to the last.
        def keys(chart, pressed):
            browser.value(f"document.querySelector('#{chart} .chart').focus()")
            for key in pressed:
                browser.call("Input.dispatchKeyEvent", type="keyDown", key=key, code=key)
                browser.call("Input.dispatchKeyEvent", type="keyUp", key=key, code=key)
            return numbers(browser.value(f"document.querySelector('#{chart} .told').textContent"))

        hold(keys("displacement", ["Home"] + ["ArrowRight"] * 3), file, 3, fan)
        survival = {
            "duration": file["duration_bin"],
            "survival": file["stick_duration_survival"],
            "count": file["stick_duration_count"],
            "survival_low": file["stick_duration_survival_low"],
            "survival_high": file["stick_duration_survival_high"],
        }
        hold(keys("survival", ["End", "ArrowLeft"]), file, -2, survival)
        shares = {
            "k": file["sub_phase"],
            "share": file["sub_phase_share"],
            "share_high": file["sub_phase_share_high"],
        }
        hold(keys("sub-phases", ["Home", "ArrowRight"]), file, 1, shares)

    # Use the buttons: linear and logarithmic, light and dark. Downloads are made without a request.
    browser.value("[...document.querySelectorAll('button')].forEach(b => b.click())")
    browser.value("document.getElementById('theme').click()")
    # A hostile title would set this variable.
    assert browser.value("typeof window.stolen") == "undefined"
    assert browser.value("[...document.scripts].length") == 3
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
        f"{report}: {len(charts)} charts, {size} bytes, loaded in {milliseconds} ms, hovering and keys show what the file says"
    )


if __name__ == "__main__":
    main(*sys.argv[1:])
