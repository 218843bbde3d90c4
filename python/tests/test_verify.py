"""A run is compared with a second simulation of its scenario, as the command does with a file."""

from __future__ import annotations

import json

import pytest
import stickslip as ss
from conftest import SCENARIOS

pytestmark = pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")

RHO025 = SCENARIOS / "rho025.toml"
SCENE = {"paths": 1500, "step": 0.05, "record": {"events": True, "trajectories": 700}}
FLAGS = [
    "--paths",
    1500,
    "--step",
    0.05,
    "--set",
    "record.events=true",
    "--set",
    "record.trajectories=700",
]

RUNS = {
    "rows of every kind": (SCENE, FLAGS),
    "no rows": (
        {**SCENE, "record": {"paths": False}},
        ["--paths", 1500, "--step", 0.05, "--set", "record.paths=false"],
    ),
    "antithetic pairs": (
        {**SCENE, "set": {"ensemble.antithetic": True}, "bias": False},
        [*FLAGS, "--set", "ensemble.antithetic=true", "--no-bias"],
    ),
    "until a goal": (
        {"until": "stick_duration_mean < 5%", "step": 0.05},
        ["--until", "stick_duration_mean < 5%", "--step", 0.05],
    ),
    "no step": (
        {"paths": 700, "scheme": "event-driven"},
        ["--paths", 700, "--scheme", "event-driven"],
    ),
}


@pytest.mark.parametrize("name", RUNS)
def test_what_is_checked_is_what_the_command_checks(name, mc, tmp_path):
    arguments, flags = RUNS[name]
    mc("run", RHO025, *flags, "--quiet", "-o", "a.h5")
    told = json.loads(mc("verify", "a.h5", "--again", "--json")[0])
    assert told["matches"]
    for run in (tmp_path / "a.h5", ss.run(RHO025, **arguments)):
        mine = ss.verify(run)
        is_file = not hasattr(run, "attrs")
        assert mine.has_checksum == (True if is_file else None)
        # The command may have been built from another commit, which changed nothing in it.
        assert mine.same_program or is_file
        assert mine.paths > 0 and mine.values_checked > 0


def test_a_part_is_refused():
    with pytest.raises(ss.ArgumentError, match="merge the parts"):
        ss.verify(ss.run(RHO025, **SCENE, part="2/3"))


CHANGES = [
    ("path_stick_time", 1499),
    ("path_sticks", 256),
    ("event_count", 1000),
    ("event_force", 1),
    ("trajectory_velocity", 699),
    ("estimate", 4),
    ("interval_high", 0),
]


@pytest.mark.parametrize(("name", "at"), CHANGES)
def test_whatever_was_changed_is_named_as_the_command_names_it(name, at, mc, tmp_path):
    h5py = pytest.importorskip("h5py")
    mc("run", RHO025, *FLAGS, "--quiet", "-o", "a.h5")
    # Another program that writes the file drops its checksum.
    with h5py.File(tmp_path / "a.h5", "r+") as file:
        place = (at, 3) if name == "trajectory_velocity" else at
        file[name][place] += 1 if file[name].dtype.kind == "u" else 1e-9
    _, said = mc("verify", "a.h5", "--again", succeeds=False)
    with pytest.raises(ss.VerificationError) as raised:
        ss.verify(tmp_path / "a.h5")
    assert raised.value.variable == name
    if name != "event_count":
        # The digits are compared, not the texts, because the exponent of a small number has two
        # digits in one language and as many as needed in the other.
        assert raised.value.problem.split(" is ")[0] in said, said
    in_memory = ss.load(tmp_path / "a.h5").load()
    with pytest.raises(ss.VerificationError, match="in the data set"):
        ss.verify(in_memory)


def test_a_seed_or_a_scenario_that_was_changed_is_found():
    run = ss.run(RHO025, **SCENE)
    run.attrs["seed"] += 1
    with pytest.raises(ss.VerificationError, match="seed is 2"):
        ss.verify(run)
    run.attrs["seed"] -= 1
    other = run.attrs["scenario"].replace("static = 1.2 ", "static = 1.25 ")
    assert other != run.attrs["scenario"]
    with pytest.raises(ss.VerificationError, match="^path "):
        ss.verify(run.assign_attrs(scenario=other))


def test_bytes_that_were_changed_and_files_of_many_runs(mc, tmp_path):
    mc("run", RHO025, "--paths", 300, "--quiet", "-o", "a.h5")
    changed = bytearray((tmp_path / "a.h5").read_bytes())
    changed[len(changed) // 2] ^= 1
    (tmp_path / "b.h5").write_bytes(changed)
    with pytest.raises(ss.RunError, match="checksum"):
        ss.verify(tmp_path / "b.h5")
    mc(
        "sweep",
        RHO025,
        "--vary",
        "friction.static=1.1:1.2:2",
        "--paths",
        300,
        "--quiet",
        "-o",
        "sweep.h5",
    )
    checked = ss.verify(tmp_path / "sweep.h5")
    assert checked.has_checksum and not checked.values_checked
    with pytest.raises(ss.ArgumentError, match="not the data set of a run"):
        ss.verify(ss.load(tmp_path / "a.h5").drop_attrs())
