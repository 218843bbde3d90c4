"""Each function returns what the command of the same name writes, variable by variable."""

from __future__ import annotations

import pytest
import stickslip as ss
from conftest import SCENARIOS, same

UNITS = {"units.time": "s", "units.length": "mm", "units.force": "N", "units.temperature": "K"}

RUNS = {
    "all that can be recorded, biases, labels": (
        "rho025",
        {"paths": 600, "record": {"events": True, "trajectories": 3}, "set": UNITS},
        [
            "--set",
            "record.events=true",
            "--set",
            "record.trajectories=3",
            *(f"--set={k}={v}" for k, v in UNITS.items()),
        ],
    ),
    "no rows of single paths": (
        "rho025",
        {"paths": 300, "record": {"paths": False}},
        ["--set", "record.paths=false"],
    ),
    "one path without noise": ("shaw", {}, []),
    "a measured temperature and a bearing": (
        "bridge",
        {"paths": 40, "record": {"trajectories": 2}},
        ["--set", "record.trajectories=2"],
    ),
    "no stick ends": ("never-slips", {}, []),
    "no time step, another seed": (
        "rho025",
        {"paths": 300, "scheme": "event-driven", "tolerance": 1e-4, "seed": 7},
        ["--scheme", "event-driven", "--tolerance", "1e-4", "--seed", "7"],
    ),
    "paths that diverge": (
        "rho025",
        {"paths": 600, "step": 0.4, "set": {"time.output_step": 6}},
        ["--step", "0.4", "--set", "time.output_step=6"],
    ),
    "a burn-in": (
        "rho025",
        {"paths": 300, "set": {"statistics.after": 20}},
        ["--set", "statistics.after=20"],
    ),
    "antithetic pairs": (
        "rho025",
        {"paths": 300, "scheme": "event-driven", "set": {"ensemble.antithetic": True}},
        ["--scheme", "event-driven", "--set", "ensemble.antithetic=true"],
    ),
    "without the bias of the step": ("rho025", {"paths": 300, "bias": False}, ["--no-bias"]),
    "until a goal": (
        "rho025",
        {"until": ["stick_duration_mean < 4%", "50"], "bias": False},
        ["--until", "stick_duration_mean < 4%", "--until", "50", "--no-bias"],
    ),
}


@pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")
@pytest.mark.parametrize("name", RUNS)
def test_run(name, mc, tmp_path):
    scenario, arguments, flags = RUNS[name]
    path = SCENARIOS / f"{scenario}.toml"
    paths = ["--paths", arguments["paths"]] if "paths" in arguments else []
    mc("run", path, *paths, *flags, "--quiet", "-o", "run.h5")
    file = ss.load(tmp_path / "run.h5")
    assert len(file.variables) > 40
    same(ss.run(path, threads=2, **arguments), file)


@pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")
@pytest.mark.parametrize(
    ("scenario", "scheme"),
    [("rho025", "discrete-vi"), ("rho025", "event-driven"), ("bridge", None)],
)
def test_replay(scenario, scheme, mc, tmp_path):
    path = SCENARIOS / f"{scenario}.toml"
    flags = ["--scheme", scheme] if scheme else []
    mc("run", path, "--paths", "40", *flags, "--quiet", "--no-bias", "-o", "run.h5")
    mc("replay", "run.h5", "--path", "7", "-o", "one.h5")
    file = ss.load(tmp_path / "one.h5")
    same(ss.replay(ss.load(tmp_path / "run.h5"), 7), file)
    same(ss.replay(ss.run(path, paths=40, scheme=scheme, bias=False), 7), file)


@pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")
def test_the_arrays_are_those_that_the_engine_filled():
    """No copy is made: an array does not own its memory, because that belongs to the engine."""
    values = ss.run("rho025", paths=256, bias=False).path_displacement_end.to_numpy()
    assert not values.flags.owndata
    assert (
        type(values.base if values.base.base is None else values.base.base).__name__
        == "PySliceContainer"
    )
