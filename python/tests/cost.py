"""Measure the CPU time of a run from Python and on the command line, the time of an import, and how
long Ctrl-C takes.

    target/venv-python/bin/python python/tests/cost.py
"""

import resource
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

ROOT = Path(__file__).parents[2]
SCENARIO, PATHS, TIMES = ROOT / "scenarios/rho025.toml", 100_000, 8


def cpu(of):
    used = resource.getrusage(of)
    return used.ru_utime + used.ru_stime


start = time.perf_counter()
import stickslip as ss  # noqa: E402

print(f"import stickslip {time.perf_counter() - start:.3f} s")
warnings.simplefilter("ignore")
ss.run(SCENARIO, paths=256)
here, there = [], []
with tempfile.TemporaryDirectory() as folder:
    command = [
        ROOT / "target/release/mc",
        "run",
        SCENARIO,
        "--paths",
        str(PATHS),
        "--quiet",
        "--force",
        "-o",
        f"{folder}/run.h5",
    ]
    for _ in range(TIMES):
        start = cpu(resource.RUSAGE_SELF)
        ss.run(SCENARIO, paths=PATHS)
        here.append(cpu(resource.RUSAGE_SELF) - start)
        start = cpu(resource.RUSAGE_CHILDREN)
        subprocess.run(command, check=True, stderr=subprocess.DEVNULL)
        there.append(cpu(resource.RUSAGE_CHILDREN) - start)
print(
    f"ss.run {min(here):.2f} s, mc run {min(there):.2f} s, ratio {min(here) / min(there):.2f}; {PATHS} paths, the least of {TIMES}"
)

from test_interrupt import INTERRUPTED  # noqa: E402

waits = []
for _ in range(TIMES):
    done = subprocess.run(
        [sys.executable, "-c", INTERRUPTED], capture_output=True, text=True, check=True
    )
    waits.append(float(done.stdout.split()[0]))
print(
    f"Ctrl-C is answered after {statistics.median(waits):.2f} s, at most {max(waits):.2f} s; {TIMES} times"
)
