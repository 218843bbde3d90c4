"""The machine that the numbers were measured on: processor, compilers, packages."""

import os
import pathlib
import platform
import re
import subprocess

from lineup import work

INSTRUCTIONS = ("sse4_2", "avx", "avx2", "fma", "avx512f", "avx512dq", "avx512vl", "asimd", "sve")


def cpuinfo(key):
    found = (
        re.search(rf"^{key}\s*:\s*(.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.M)
        if os.path.exists("/proc/cpuinfo")
        else None
    )
    return found.group(1) if found else ""


def model():
    return cpuinfo("model name") or platform.processor() or platform.machine()


def slug():
    return re.sub(r"[^a-z0-9]+", "-", model().lower()).strip("-")


def first_line(*command):
    try:
        return subprocess.run(
            command, capture_output=True, text=True, check=True
        ).stdout.splitlines()[0]
    except (OSError, subprocess.CalledProcessError, IndexError):
        return f"no {command[0]}"


def describe():
    """A few lines for the head of the table."""
    flags = (cpuinfo("flags") or cpuinfo("Features")).split()
    family = ", ".join(
        f"{key} {cpuinfo(key)}" for key in ("cpu family", "model", "stepping") if cpuinfo(key)
    )
    packages = sorted(
        path.name.removesuffix(".dist-info").replace("-", " ")
        for name in ("numpy", "numba", "jax", "jaxlib", "diffrax")
        for path in work.glob(f"venv/lib/python*/site-packages/{name}-*.dist-info")
    )
    return [
        f"{model()} ({family}), {os.cpu_count()} cores, {' '.join(flag for flag in INSTRUCTIONS if flag in flags)}",
        f"{first_line('rustc', '--version')}; {first_line('g++', '--version')}; Python {platform.python_version()}",
        ", ".join(packages) or "no Python packages",
    ]
