"""The peers: the name and precision of each, and how it is built and started.

A peer that cannot be built here stays in the list with the reason, so that the table shows what was
not compared.
"""

import dataclasses
import os
import pathlib
import subprocess
import sys

here = pathlib.Path(__file__).resolve().parent
root = here.parent.parent
target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", root / "target"))
work = target / "peers"


@dataclasses.dataclass
class Peer:
    name: str
    precision: str
    command: list  # without the arguments: paths, end, threads, option
    paths: int = 10000
    option: str = ""
    absent: str = ""  # why it cannot run
    # (our run before, its result, our run after)
    runs: list = dataclasses.field(default_factory=list)


def attempt(*command, **options):
    """Runs a building command; returns "" or the reason why it failed."""
    try:
        subprocess.run(
            [str(word) for word in command], check=True, capture_output=True, text=True, **options
        )
        return ""
    except FileNotFoundError:
        return f"{command[0]} is not installed"
    except subprocess.CalledProcessError as error:
        return f"{pathlib.Path(command[0]).name} failed: {last_line(error.stderr)}"


def last_line(text):
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    return lines[-1][:100] if lines else "no message"


def build(threads):
    """Builds `mc` and every peer; returns the command of the one and the list of the others."""
    work.mkdir(parents=True, exist_ok=True)
    failure = attempt("cargo", "build", "--release", "--quiet", "--bin", "mc", cwd=root)
    if failure:
        sys.exit(f"mc: {failure}")
    ours = [
        target / "release" / "mc",
        "run",
        root / "scenarios" / "rho025.toml",
        "--step",
        "0.001",
        "--until",
        "12",
        "--paths",
        "10000",
        "--set",
        "time.output_step=0.5",
        "--threads",
        threads,
        "--quiet",
        "--json",
        "--force",
        "-o",
        work / "ours.h5",
    ]
    return [str(word) for word in ours], cpp() + rust() + python() + torch()


def cpp():
    def one(name, precision, source, *flags):
        program = work / "-".join(name.replace(",", "").split() + [precision.split()[0]])
        failure = attempt(
            "g++",
            "-std=c++17",
            "-O3",
            "-march=native",
            "-fopenmp",
            *flags,
            here / "cpp" / source,
            "-o",
            program,
        )
        return Peer(name, precision, [program], absent=failure)

    fast = ["-ffast-math", "-mprefer-vector-width=512"]
    return [
        one("C++ lanes, -ffast-math", "f32", "lanes.cpp", "-DREAL=float", *fast),
        one("C++ lanes, -ffast-math", "f64, normals f32", "lanes.cpp", "-DREAL=double", *fast),
        one("C++ scalar, ziggurat", "f64", "scalar.cpp", "-DFAST_NORMALS"),
        one("C++ scalar, std::normal_distribution", "f64", "scalar.cpp"),
    ]


def rust():
    failure = attempt(
        "cargo",
        "build",
        "--release",
        "--quiet",
        "--locked",
        "--target-dir",
        work / "rust",
        cwd=here / "rust",
    )

    def one(name, program, **more):
        return Peer(name, "f64", [work / "rust" / "release" / program], absent=failure, **more)

    return [
        one("Rust scalar, rand_pcg", "scalar_pcg"),
        one("Rust scalar, xoshiro256++", "scalar_xoshiro"),
        one("Rust, differential-equations", "differential_equations", paths=2000),
    ]


def python():
    environment, needs = work / "venv", here / "requirements.txt"
    interpreter, stamp = environment / "bin" / "python", environment / "requirements.txt"
    failure = ""
    if not stamp.exists() or stamp.read_text() != needs.read_text():
        failure = attempt(sys.executable, "-m", "venv", environment) or attempt(
            interpreter, "-m", "pip", "install", "--quiet", "-r", needs
        )
        if not failure:
            stamp.write_text(needs.read_text())

    def one(name, precision, script, **more):
        return Peer(
            name, precision, [interpreter, here / "python" / script], absent=failure, **more
        )

    return [
        one("JAX, fori_loop", "f32", "jax_loop.py", option="f32"),
        one("JAX, fori_loop", "f64", "jax_loop.py", option="f64"),
        one("NumPy, vectorised", "f64", "numpy_vectorised.py"),
        one("Numba, parallel", "f64", "numba_parallel.py", paths=5000),
        one("diffrax, UnsafeBrownianPath", "f64", "diffrax_euler.py", option="unsafe"),
        one("diffrax, VirtualBrownianTree", "f64", "diffrax_euler.py", option="tree", paths=500),
    ]


def torch():
    """PyTorch is large: used where the system's or the caller's Python has it, never installed."""
    for interpreter in ("/usr/bin/python3", sys.executable):
        if not attempt(interpreter, "-c", "import torch"):
            return [
                Peer("PyTorch, tensors", "f64", [interpreter, here / "python" / "torch_tensors.py"])
            ]
    return [Peer("PyTorch, tensors", "f64", [], absent="torch is not installed")]
