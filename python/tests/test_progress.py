"""Long work shows in terminals and notebooks how far it has come, and Ctrl-C ends it."""

from __future__ import annotations

import os
import pty
import signal
import subprocess
import sys
import threading
import time

import pytest
import stickslip as ss
from conftest import ROOT

pytestmark = pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")

BRIDGE = ROOT / "examples/bridge/bridge.toml"
BEARING = ROOT / "examples/bridge/bearing.toml"
TWIN = ROOT / "examples/bridge/twin.csv"

#: What is being done, and work that does it for seconds.
LONG = {
    "simulating": lambda **more: ss.sweep("rho025", {"friction.static": [1.2]}, paths=10**7, **more),
    "pilot run: ": lambda **more: ss.run("rho025", accuracy=0.01, **more),
    "measuring for about 60": lambda **more: ss.trade("rho025", budget=60, **more),
    "calibrating the bearing": lambda **more: ss.calibrate(
        BRIDGE, TWIN, method="both", starts=100, **more
    ),
    "fitting the temperature model": lambda **more: ss.fit_temperature(TWIN, **more),
    "simulating the temperature": lambda **more: ss.twin(
        BEARING, duration="60000d", **more
    ),
}


@pytest.mark.parametrize("stage", LONG)
def test_ctrl_c_ends_long_work_that_reports_its_stage(stage):
    came, stages = [], []

    def interrupt():
        came.append(time.monotonic())
        os.kill(os.getpid(), signal.SIGINT)

    def begun(done, expected, what):
        if not stages:
            threading.Timer(0.1, interrupt).start()
        stages.append(what)

    try:
        # Only a trade has partial results so early.
        assert LONG[stage](progress=begun).attrs["format_name"] == "stick-slip trade"
    except KeyboardInterrupt:
        pass
    # 0.3 s on an idle machine; other tests and builds may run on this one.
    assert time.monotonic() - came[0] < 1
    assert any(what.startswith(stage) for what in stages), set(stages)


def test_short_work_reports_its_stages():
    """The last stage is reported however short it is."""
    stages = []

    def callback(done, expected, what):
        stages.append((done, expected, what))

    parts = [ss.run("rho025", paths=2560, part=f"{i}/2", progress=callback) for i in (1, 2)]
    assert stages[-1] == (1280, 1280, "simulating")
    run = ss.merge(parts, progress=callback)
    assert stages[-1] == (2560, 2560, "estimating the bias of the step")
    ss.verify(run, progress=callback)
    assert stages[-1] == (2560, 2560, "estimating the bias of the step")
    ss.replay(run, 7, progress=callback)
    assert stages[-1] == (0, 0, "simulating the path")
    ss.twin("bridge", progress=callback)
    assert stages[-1] == (0, 0, "making the record")
    ss.forecast(BRIDGE, TWIN, draws=2, years=2, progress=callback)
    # Two for each draw, and ten times as many for the most likely parameters.
    assert stages[-1] == (0, 0, "simulating 24 years")


RUN = "import stickslip as ss; ss.run('rho025', paths=10**9, max_time=3.5, bias=False)"


def shown_in_terminal(command, **where):
    """What a successful command writes to standard error if that is a terminal."""
    master, slave = pty.openpty()
    done = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=slave, **where)
    os.close(slave)
    shown = b""
    try:
        while chunk := os.read(master, 4096):
            shown += chunk
    except OSError:  # The terminal has no writer any more.
        pass
    os.close(master)
    assert done.wait() == 0, shown
    return shown.decode()


def test_a_terminal_shows_a_line_that_is_gone_at_the_end():
    lines = shown_in_terminal([sys.executable, "-W", "ignore", "-c", RUN]).split("\r")
    shown = [line for line in lines if "of 1,000,000,000 paths, 0:00:0" in line]
    assert shown and all(line.startswith("simulating: ") for line in shown), lines
    assert "left" in shown[-1] and lines[-2].strip() == "" == lines[-1], lines


@pytest.mark.parametrize(
    ("arguments", "stage"),
    [
        (["verify", "run.h5", "--again"], "/2,560 paths"),
        (["replay", "run.h5", "--path", "3"], "simulating the trajectory"),
        (["verify", "sweep.h5", "--again"], "/600 paths"),
        (["verify", "fit.h5", "--again"], "calibrating the bearing again"),
        (["twin", str(BEARING), "-o", "twin.csv"], "making the record"),
    ],
)
def test_the_command_shows_its_stage_in_a_terminal(arguments, stage, mc, tmp_path):
    made = {
        "run.h5": ("run", "rho025", "--paths", 2560),
        "sweep.h5": ("sweep", "rho025", "--vary", "friction.static=1.1,1.2", "--paths", 300),
        "fit.h5": ("calibrate", BRIDGE, TWIN),
    }
    if arguments[1] in made:
        mc(*made[arguments[1]], "-o", arguments[1])
    command = os.environ.get("MC", str(ROOT / "target/release/mc"))
    assert stage in shown_in_terminal([command, *arguments], cwd=tmp_path)


def test_a_notebook_shows_the_line_and_nothing_else_does():
    nbformat, nbclient = pytest.importorskip("nbformat"), pytest.importorskip("nbclient")
    cells = [nbformat.v4.new_code_cell(f"import warnings; warnings.simplefilter('ignore'); {RUN};")]
    notebook = nbformat.v4.new_notebook(cells=cells)
    nbclient.NotebookClient(notebook, timeout=60, kernel_name="python3").execute()
    shown = "".join(output.get("text", "") for output in notebook.cells[0].outputs)
    assert "\rsimulating: " in shown and "of 1,000,000,000 paths, 0:00:02" in shown
    code = [sys.executable, "-W", "ignore", "-c", RUN]
    assert subprocess.run(code, capture_output=True, check=True).stderr == b""
