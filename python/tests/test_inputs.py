"""A scenario is the same as a file, a text, a name and a dictionary, and so is a temperature in
each form."""

from __future__ import annotations

import tomllib
from datetime import timedelta

import numpy as np
import pytest
import stickslip as ss
from conftest import SCENARIOS, same

pytestmark = pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")


def test_a_dictionary_a_text_a_name_and_a_file_are_one_scenario():
    path = SCENARIOS / "rho025.toml"
    by_file = ss.run(path, paths=256)
    for other in (str(path), path.read_text(), "rho025", tomllib.loads(path.read_text())):
        same(ss.run(other, paths=256), by_file)


@pytest.mark.parametrize(
    "name",
    sorted(path.stem for path in SCENARIOS.glob("*.toml") if "series" not in path.read_text()),
)
def test_every_scenario_goes_through_a_dictionary(name):
    path = SCENARIOS / f"{name}.toml"
    assert ss.check(tomllib.loads(path.read_text())).toml == ss.check(path).toml


def test_a_nested_dictionary_sets_its_keys_and_leaves_the_others():
    dotted = ss.check("rho025", set={"friction.static": 1.3, "temperature.noise.intensity": 0.1})
    nested = {"friction": {"static": 1.3}, "temperature": {"noise": {"intensity": 0.1}}}
    assert ss.check("rho025", set=nested) == dotted
    assert ss.check("rho025", set={"temperature.noise": {"intensity": 0.1}, **nested}) == dotted
    assert ss.check("duffing", set={"parameters": {"k3": 0.03}}) == ss.check(
        "duffing", set={"parameters.k3": 0.03}
    )


def test_the_shipped_scenarios_have_titles():
    shipped = ss.scenarios()
    assert set(shipped) == {path.stem for path in SCENARIOS.glob("*.toml")}
    assert shipped["rho025"] == ss.check("rho025").title


@pytest.mark.parametrize(
    ("text", "seconds"),
    [
        ("90", 90.0),
        ("90s", 90.0),
        ("10m", 600.0),
        ("10 min", 600.0),
        ("1.5h", 5400.0),
        ("4h50m", 17_400.0),
        ("1d 2h", 93_600.0),
        (timedelta(minutes=10), 600.0),
        (1e3, 1000.0),
    ],
)
def test_a_length_of_time_is_a_number_a_text_or_a_timedelta(text, seconds):
    by_text = ss.twin("viaduct", duration=4 * seconds, every=text)
    same(by_text, ss.twin("viaduct", duration=4 * seconds, every=seconds))
    assert ss.run("rho025", paths=256, bias=False, max_time=text).attrs["status"] == "complete"


def test_numbers_of_numpy_are_numbers():
    plain = ss.check(
        "rho025", set={"friction.static": 1.3, "ensemble.paths": 500, "record.events": True}
    )
    numpy = ss.check(
        "rho025",
        set={
            "friction.static": np.float64(1.3),
            "ensemble.paths": np.int64(500),
            "record.events": np.True_,
        },
    )
    assert plain == numpy
    assert "static = 1.3" in plain.toml


def test_a_check_says_what_follows_and_what_to_beware_of(mc):
    import json

    printed, _ = mc("check", SCENARIOS / "rho025.toml", "--json")
    theirs, mine = json.loads(printed), ss.check(SCENARIOS / "rho025.toml")
    assert mine.toml == theirs["resolved"]
    assert mine.derived == theirs["derived"]
    said = {warning["name"]: warning["text"] for warning in theirs["warnings"]}
    assert any('`scheme.kind = "event-driven"`' in text for text in said.values())
    assert mine.warnings == said


TIMES = np.arange(0.0, 201.0, 0.5)
VALUES = 8 * np.cos(0.25 * TIMES)


def measured(time_unit=""):
    """rho025 without harmonics, to be driven by samples."""
    scenario = tomllib.loads((SCENARIOS / "rho025.toml").read_text())
    del scenario["temperature"]["harmonics"]
    scenario["units"] = {"time": time_unit}
    return scenario


def test_samples_in_memory_are_those_of_a_file(tmp_path):
    """The data sets differ only in what the scenario says about the file."""
    rows = (f"{t!r},{v!r}" for t, v in zip(TIMES.tolist(), VALUES.tolist()))
    (tmp_path / "t.csv").write_text("time,temperature\n" + "\n".join(rows) + "\n")
    from_file = measured()
    from_file["temperature"]["series"] = {"file": str(tmp_path / "t.csv")}
    by_file = ss.run(from_file, paths=64)
    in_memory = ss.run(measured(), paths=64, temperature=(TIMES, VALUES))
    same(in_memory, by_file, but=["scenario"])
    assert in_memory.series_temperature.to_numpy().tobytes() == VALUES.tobytes()
    # One path of it can be simulated again.
    assert ss.replay(in_memory, 3).path_sticks.item() == in_memory.path_sticks.sel(path=3).item()


BLOCK = {
    "oscillator": {"mass": 1, "stiffness": 0, "dilatation": 0},
    "friction": {"static": 5, "dynamic": 5},
    "force": {"expression": "-ag"},
    "initial": {"displacement": 0},
    "time": {"end": 20},
    "scheme": {"kind": "event-driven"},
}


def test_an_input_in_memory_is_that_of_a_file(tmp_path):
    rows = (f"{t!r},{v!r}" for t, v in zip(TIMES.tolist(), VALUES.tolist()))
    (tmp_path / "q.csv").write_text("time,ag\n" + "\n".join(rows) + "\n")
    by_file = ss.run({**BLOCK, "input": {"ag": {"file": str(tmp_path / "q.csv")}}}, paths=1)
    in_memory = ss.run(BLOCK, paths=1, inputs={"ag": (TIMES, VALUES)})
    same(in_memory, by_file, but=["scenario"])
    assert in_memory.input.values.tolist() == ["ag"]
    assert in_memory.input_value.to_numpy().tobytes() == VALUES.tobytes()
    assert ss.replay(in_memory, 0).path_slips.item() == in_memory.path_slips.item() > 0
    with pytest.raises(ss.ArgumentError, match="is not a number") as raised:
        ss.run(BLOCK, inputs={"ag": ([0.0, 1.0], [1.0, float("nan")])})
    assert raised.value.argument == "inputs.ag"


def test_a_series_with_dates_is_in_seconds():
    pandas = pytest.importorskip("pandas")
    dates = pandas.Timestamp("2026-03-01") + pandas.to_timedelta(TIMES, unit="s")
    by_dates = ss.run(measured("s"), paths=64, temperature=pandas.Series(VALUES, index=dates))
    same(by_dates, ss.run(measured("s"), paths=64, temperature=(TIMES, VALUES)))
    with pytest.raises(ss.ArgumentError, match="times are in seconds") as raised:
        ss.run(measured("h"), temperature=pandas.Series(VALUES, index=dates))
    assert raised.value.argument == "temperature"


@pytest.mark.parametrize(
    ("samples", "problem"),
    [
        (([0.0, 1.0], [1.0]), "have different shapes"),
        (([0.0, 1.0], [1.0, float("nan")]), "the samples"),
        (3.0, "no times and values"),
        (([0.0, 1.0], np.ma.array([1.0, 2.0], mask=[False, True])), "the samples"),
        ((np.ma.array([0.0, 1.0], mask=[False, True]), [1.0, 2.0]), "a masked time"),
    ],
)
def test_samples_that_make_no_sense_are_refused(samples, problem):
    with pytest.raises(ss.ArgumentError, match=problem) as raised:
        ss.run(measured(), temperature=samples)
    assert raised.value.remedy


def test_a_force_is_an_expression_with_parameters():
    text = (SCENARIOS / "duffing.toml").read_text()
    written = ss.run(text.replace("k3 = 0.02", "k3 = 0.03"), paths=256)
    changed = {"parameters.k3": 0.03, "title": written.attrs["title"]}
    same(ss.run("duffing", set=changed, paths=256), written)
    with pytest.raises(ss.errors.ScenarioError, match=r"unknown name `y`\n  -y\*x\n   \^"):
        ss.run("duffing", set={"force.expression": "-y*x"})
