"""One run of `mc` or of a peer, as a dictionary with times in nanoseconds for each path-step.

`wall` is the wall-clock time and `cpu` the processor time; on a machine that is shared with others,
only the second one is meaningful on one core. A peer measures its simulation only, without start-up
and compilation. For `mc` the wall-clock time is that of the whole run with statistics and file, and
the processor time that of the whole process.
"""

import json
import os
import resource
import subprocess

from lineup import last_line

LIMIT = 300  # the longest time of a peer in seconds


def pin(threads):
    """Keep this process and its children on as many cores as there are threads. Returns these
    cores, or None where that is not possible."""
    if not hasattr(os, "sched_setaffinity"):
        return None
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:threads])
    return sorted(os.sched_getaffinity(0))


def start(command):
    return subprocess.run(
        [str(word) for word in command],
        capture_output=True,
        text=True,
        timeout=LIMIT,
        env={**os.environ, "PYTHONDONTWRITEBYTECODE": "1"},
    )


def ours(command):
    used = processor_time()
    done = start(command)
    used = processor_time() - used
    if done.returncode:
        raise SystemExit(f"mc: {done.stderr}")
    told = json.loads(done.stdout)
    path_steps = told["seconds"] * 1e9 / told["ns_per_path_step"]
    named = told["statistics"]
    return {
        "wall": told["ns_per_path_step"],
        "cpu": used * 1e9 / path_steps,
        "setup": 0.0,
        "paths": told["paths"],
        "sticks": named["sticks_per_path"],
        "duration": named["stick_duration_mean"],
    }


def processor_time():
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def peer(peer, threads):
    """Its result, or None with the reason in `peer.absent`."""
    try:
        done = start(
            [*peer.command, peer.paths, 12, threads, *([peer.option] if peer.option else [])]
        )
        told = json.loads(done.stdout)
    except subprocess.TimeoutExpired:
        peer.absent = f"took longer than {LIMIT} s"
    except ValueError:
        peer.absent = f"failed: {last_line(done.stderr)}"
    else:
        scale = 1e9 / (told["paths"] * told["steps"])
        return {
            "wall": told["seconds"] * scale,
            "cpu": told["cpu_seconds"] * scale,
            "setup": told["setup_seconds"],
            "paths": told["paths"],
            "sticks": told["sticks_per_path"],
            "duration": told["stick_duration_mean"],
        }
    return None
