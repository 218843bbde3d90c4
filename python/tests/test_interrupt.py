"""Ctrl-C in a run, and callbacks."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
import time

import pytest
import stickslip as ss

pytestmark = pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")

LONG = {"paths": 10**9, "bias": False}


INTERRUPTED = """
import os, signal, threading, time, warnings
import stickslip as ss

came = []

def interrupt():
    came.append(time.monotonic())
    os.kill(os.getpid(), signal.SIGINT)

def begun(done, expected, stage):
    # Half a second after the first blocks are done.
    if done and not threads:
        threads.append(threading.Timer(0.5, interrupt))
        threads[0].start()

threads = []
with warnings.catch_warnings(record=True) as said:
    warnings.simplefilter("always")
    ds = ss.run("rho025", paths=10**9, bias=False, progress=begun)
late = time.monotonic() - came[0]
assert any("interrupted after" in str(warning.message) for warning in said)
print(late, ds.attrs["status"], int(ds.attrs["completed_paths"]), ds.estimate.to_numpy().tobytes().hex())
"""


def test_ctrl_c_returns_what_is_done():
    """Runs in a process of its own, in which nothing is imported yet that is needed only after
    Ctrl-C."""
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED], capture_output=True, text=True, check=True
    )
    late, status, paths, estimates = done.stdout.split()
    assert status == "interrupted" and 0 < int(paths) < 10**9 and int(paths) % 256 == 0
    # The result equals a run of so many paths, to the last bit.
    assert (
        ss.run("rho025", paths=int(paths), bias=False).estimate.to_numpy().tobytes().hex()
        == estimates
    )
    # 0.3 s are documented for an idle machine; other tests and builds may run on this one.
    assert float(late) < 1, late


def test_ctrl_c_before_the_first_block_is_an_interrupt():
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt):
        ss.run("rho025", paths=10**6, step=1e-6, bias=False, threads=1)


def test_ctrl_c_before_the_first_point_is_an_interrupt():
    threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
    with pytest.raises(KeyboardInterrupt, match="before the first point"):
        ss.sweep("rho025", {"friction.static": [1.1, 1.2]}, paths=10**7, threads=1)


def test_other_threads_of_python_run_meanwhile():
    """The interpreter lock is released: another thread continues to count."""
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    ss.run("rho025", until="stick_duration_mean < 0.0001%", max_time=0.5, bias=False)
    stop.set()
    thread.join()
    assert counted[0] > 50


def test_a_callback_hears_of_all_paths():
    heard = []
    ss.run(
        "rho025",
        paths=2560,
        bias=False,
        progress=lambda done, expected, stage: heard.append((done, expected)),
    )
    assert heard[-1] == (2560, 2560)
    assert heard == sorted(heard)


def test_an_exception_of_a_callback_ends_the_run():
    def refuse(done, expected, stage):
        raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        ss.run("rho025", **LONG, progress=refuse)


def test_the_package_is_imported_quickly():
    """xarray takes most of a second to import; it is imported when a data set is made."""
    code = "import sys, stickslip; print('xarray' in sys.modules, 'pandas' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False"] * 2


def test_the_version_is_that_of_the_command(mc):
    assert mc("--version")[0].split()[1] == ss.__version__
    from importlib.metadata import version

    assert version("stickslip") == ss.__version__


DRAWN = """
import os, signal, threading
import stickslip as ss

# The path has 10^10 steps and no event, so that it takes longer than the test may.
stuck = {"friction.static": 1e6, "time.end": 1e8, "time.output_step": 1e6}
threading.Timer(1.0, lambda: os.kill(os.getpid(), signal.SIGINT)).start()
try:
    ss.plot("rho025", set=stuck)
except KeyboardInterrupt:
    print("interrupted")
    os._exit(0)
"""


def test_ctrl_c_ends_a_drawing():
    command = [sys.executable, "-c", DRAWN]
    done = subprocess.run(command, capture_output=True, text=True, check=True, timeout=60)
    assert done.stdout == "interrupted\n"
