#!/usr/bin/env python3
"""Print the largest resident set of `mc run` against the number of paths, as in
docs/performance.md.

Each scheme runs `scenarios/rho025.toml` for one unit of time, with and without rows of single
paths. The largest resident set is the one that the kernel reports for the ended process
(ru_maxrss). It takes some minutes, and up to 1.5 GB of disk.

    cargo build --release && tools/memory.py target/release/mc
"""

import os
import subprocess
import sys
import tempfile

PATHS = [100_000, 1_000_000, 10_000_000]
SCHEMES = ["discrete-vi", "corrected-vi", "event-driven", "quasi-static"]
SCENARIO = os.path.join(
    os.path.dirname(os.path.abspath(__file__)), "..", "scenarios", "rho025.toml"
)


def megabytes(mc, scheme, paths, rows, folder):
    """The largest resident set of one run, in MB."""
    keys = ["time.end=1", "time.output_step=0.1", f"record.paths={rows}"]
    changes = [word for key in keys for word in ("--set", key)]
    command = [
        mc,
        "run",
        SCENARIO,
        "--scheme",
        scheme,
        "--paths",
        str(paths),
        "--threads",
        "2",
        "--no-bias",
        "--quiet",
    ]
    with subprocess.Popen(
        [*command, *changes, "-o", "run.h5"], cwd=folder, stderr=subprocess.DEVNULL
    ) as run:
        _, status, usage = os.wait4(run.pid, 0)
        run.returncode = os.waitstatus_to_exitcode(status)
    if run.returncode != 0:
        sys.exit(f"{' '.join(run.args)}: exit code {run.returncode}")
    os.remove(os.path.join(folder, "run.h5"))
    return usage.ru_maxrss * 1024 / 1e6


def main():
    mc = os.path.abspath(sys.argv[1] if len(sys.argv) > 1 else "target/release/mc")
    print(
        "| scheme | rows of single paths |"
        + "".join(f" {paths:.0e} paths |".replace("e+0", "e") for paths in PATHS)
    )
    print("|---|---|" + "---|" * len(PATHS))
    with tempfile.TemporaryDirectory() as folder:
        for scheme in SCHEMES:
            for rows in ("true", "false"):
                cells = [
                    f" {megabytes(mc, scheme, paths, rows, folder):.0f} MB |" for paths in PATHS
                ]
                print(
                    f"| `{scheme}` | {'yes' if rows == 'true' else 'no'} |" + "".join(cells),
                    flush=True,
                )


if __name__ == "__main__":
    main()
