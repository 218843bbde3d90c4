"""Messages are those of the command in words of Python, and exceptions have their parts as
attributes."""

from __future__ import annotations

import pytest
import stickslip as ss
from conftest import ROOT, SCENARIOS

BEARING = {
    "oscillator": {"stiffness": 2.5e8, "dilatation": 4e-4},
    "friction": {"static": 5e5, "dynamic": 4.5e5},
}

FAULTS = {
    "a key that is misspelt": ("[friction]\nstatic = ", "[friction]\nsttic = "),
    "a value out of range": ("dynamic = 1.0", "dynamic = -1.0"),
    "a word where a number is": ("mass = 1.0", 'mass = "one"'),
}


@pytest.mark.parametrize("name", FAULTS)
def test_the_message_of_a_text_is_that_of_its_file(name, mc, tmp_path):
    before, after = FAULTS[name]
    text = (SCENARIOS / "rho025.toml").read_text()
    assert before in text
    (tmp_path / "mine.toml").write_text(text.replace(before, after))
    _, message = mc("check", "mine.toml", succeeds=False)
    with pytest.raises(ss.ScenarioError) as of_text:
        ss.check(text.replace(before, after))
    with pytest.raises(ss.ScenarioError) as of_file:
        ss.run(tmp_path / "mine.toml")
    parts = of_text.value
    assert f"error: {parts}".replace("scenario:", "mine.toml:", 1).strip() == message.strip()
    assert str(of_file.value).endswith(str(parts).split(":", 1)[1])
    assert "^" in parts.excerpt
    assert (parts.key is None) == (name == "a key that is misspelt")
    assert parts.remedy and parts.line and parts.column
    assert (
        text.replace(before, after)
        .splitlines()[parts.line - 1]
        .startswith(after.splitlines()[-1].split("=")[0])
    )


def test_a_message_names_the_argument_instead_of_a_flag(mc):
    _, message = mc(
        "check", SCENARIOS / "rho025.toml", "--set", "friction.static=0.5", succeeds=False
    )
    with pytest.raises(ss.ScenarioError) as raised:
        ss.run("rho025", set={"friction.static": 0.5})
    origin = "set friction.static = 0.5"
    assert f"error: {raised.value}".replace(origin, "--set friction.static=0.5") == message.strip()
    assert raised.value.origin == origin
    assert raised.value.key == "friction.static" and raised.value.value == "0.5"
    with pytest.raises(ss.ScenarioError, match="^set friction.static = 0.5: "):
        ss.twin("viaduct", set={"friction.static": 0.5})


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"paths": 0}, ["paths = 0: "]),
        ({"step": 0.1, "scheme": "event-driven"}, ["step = 0.1: ", '`scheme.kind = "discrete-vi"`']),
        ({"scheme": "event"}, ["scheme = event: ", 'did you mean "event-driven"']),
        ({"set": {"friction": {"sttic": 1}}}, ["set friction.sttic = 1: "]),
        ({"set": {"friction.static.x": 1}}, ["set `friction.static` itself"]),
    ],
)
def test_a_message_about_a_scenario_speaks_of_arguments(arguments, words):
    with pytest.raises(ss.ScenarioError) as raised:
        ss.run("rho025", **arguments)
    assert "--" not in str(raised.value) and "`mc " not in str(raised.value)
    assert all(word in str(raised.value) for word in words), raised.value


def test_a_missing_scenario_does_not_mention_the_command():
    for missing in ("no-such-file.toml", "no/rho025.toml", "."):
        with pytest.raises(ss.ScenarioError, match="fix:") as raised:
            ss.run(missing)
        assert "mc " not in str(raised.value) and "mc " not in raised.value.remedy


def test_a_warning_speaks_of_arguments():
    with pytest.warns(ss.StickSlipWarning, match='`scheme.kind = "event-driven"` has none'):
        ss.run("rho025", paths=256, bias=False, scheme="corrected-vi", step=0.05)


@pytest.mark.parametrize(
    "call",
    [
        lambda: ss.twin({"temperature": {"series": {"file": "none.csv"}}, **BEARING}),
        lambda: ss.calibrate(BEARING, "none.csv"),
        lambda: ss.fit_temperature("none.csv"),
        lambda: ss.fit_temperature(([0.0, 0.0], [1.0, 2.0])),
        lambda: ss.sweep("rho025", {"friction.static": "1:2"}),
        lambda: ss.sweep("rho025", {"friction.static": []}),
        lambda: ss.run("rho025", temperature=([0.0, 0.0], [1.0, 2.0])),
    ],
)
def test_a_message_has_its_remedy_once(call):
    with pytest.raises(ss.ArgumentError) as raised:
        call()
    error = raised.value
    assert str(error).count("fix: ") == 1 and str(error).endswith(error.remedy), error
    assert error.problem and "fix: " not in error.problem


@pytest.mark.parametrize(
    ("arguments", "argument"),
    [
        ({"until": "stick_duration_mean < soon"}, "until"),
        ({"until": ["10", "20"]}, "until"),
        ({"max_time": "soon"}, "max_time"),
        ({"threads": -1}, "threads"),
        ({"threads": 2**64}, "threads"),
        ({"threads": 1.5}, "threads"),
        ({"set": {"friction.static": object()}}, "friction.static"),
    ],
)
def test_an_argument_that_is_wrong_is_named(arguments, argument):
    with pytest.raises(ss.ArgumentError) as raised:
        ss.run("rho025", **arguments)
    assert raised.value.argument == argument and raised.value.remedy


@pytest.mark.parametrize("threads", [0, 2**64])
def test_every_function_with_threads_says_how_many_there_are(threads):
    bridge = ROOT / "examples/bridge/bridge.toml"
    twin = ROOT / "examples/bridge/twin.csv"
    run = ss.run("rho025", paths=256, bias=False, threads=1)
    for call in (
        lambda: ss.sweep("rho025", vary={"friction.static": [1.1, 1.2]}, threads=threads),
        lambda: ss.trade("rho025", budget=1, threads=threads),
        lambda: ss.calibrate(bridge, twin, threads=threads),
        lambda: ss.forecast(bridge, twin, threads=threads),
        lambda: ss.verify(run, threads=threads),
    ):
        with pytest.raises(ValueError, match="1 to 1024"):
            call()


@pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")
def test_a_path_that_is_not_there_is_refused():
    run = ss.run("rho025", paths=256, bias=False)
    with pytest.raises(ss.ArgumentError, match="from 0 to 255"):
        ss.replay(run, 256)
    with pytest.raises(ss.ArgumentError, match="not the data set of a run"):
        ss.replay(run.drop_attrs(), 0)


@pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")
def test_what_a_result_is_not_is_a_warning():
    with pytest.warns(ss.StickSlipWarning, match="diverged"):
        ss.run("rho025", paths=64, step=5.0, set={"time.output_step": 5}, bias=False)
