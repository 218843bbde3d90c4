"""What is of the wrong type, or says more than a real number can, is refused in the words of the
package, a flaw of the engine is an exception like any other, and unknown arguments get
suggestions."""

from __future__ import annotations

import os
import pickle
import re
import signal
import threading
import time

import numpy as np
import pytest
import stickslip as ss
import xarray as xr
from conftest import ROOT

pytestmark = pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")

BRIDGE = ROOT / "examples/bridge/bridge.toml"

MASKED = np.ma.masked_greater(np.arange(5.0), 3.5)


def of_count(values):
    """A statistic that gives these values for each path."""
    return lambda events: np.resize(values, len(events.count))


def test_user_defined_statistics_refuse_what_would_be_lost():
    def masked(events):
        return np.ma.masked_less(np.arange(float(len(events.count))), 1.0)

    def weighted(events):
        return events.per_path(np.ma.masked_less(events.time, 1.0))

    for function, problem in [
        (masked, "masked"),
        (lambda events: (events.count, masked(events)), "masked"),
        (of_count(np.array([1 + 2j])), "imaginary"),
        (of_count(np.array([1 + 0j])), "imaginary"),
        (lambda events: ["a"] * len(events.count), "not an array of numbers"),
        (lambda events: None, "returned shapes"),
        (weighted, "masked"),
        (lambda events: events.per_path(events.time + 1j), "imaginary"),
    ]:
        with pytest.raises(ss.ArgumentError, match=problem):
            ss.run("rho025", paths=256, step=0.1, bias=False, own={"mine": function})
    unmasked = np.ma.asarray(MASKED.data)
    ds = ss.run("rho025", paths=256, step=0.1, bias=False, own={"mine": of_count(unmasked)})
    assert ds.own_estimate.item() == pytest.approx(np.resize(unmasked, 256).mean())


@pytest.mark.parametrize("times", [False, True])
def test_a_measurement_has_no_imaginary_part(times):
    t = np.arange(0.0, 100.0)
    given = (t + 0j, t) if times else (t, t + 5j)
    with pytest.raises(ss.ArgumentError, match="must be real") as raised:
        ss.check("rho025", temperature=given)
    assert raised.value.argument == "temperature"


RUN = {"scenario": "rho025", "paths": 10, "step": 0.1}


@pytest.mark.parametrize(
    ("call", "argument"),
    [
        (lambda: ss.merge("x"), "parts"),
        (lambda: ss.merge([None]), "parts"),
        (lambda: ss.merge(xr.Dataset()), "parts"),
        (lambda: ss.replay(xr.Dataset(), 0), "run"),
        (lambda: ss.run(None), "scenario"),
        (lambda: ss.run(3), "scenario"),
        (lambda: ss.check(None), "scenario"),
        (lambda: ss.sweep(["rho025"], {"friction.static": [1.1]}), "scenario"),
        (lambda: ss.sweep("rho025", {"friction.static": [1.1]}, bias="no"), "bias"),
        (lambda: ss.replay(ss.run(**RUN), -1), "path"),
        (lambda: ss.run(**RUN, part=3), "part"),
        (lambda: ss.plot("rho025", path="one"), "path"),
        (lambda: ss.twin("bridge", seed="one"), "seed"),
        (lambda: ss.twin("bridge", gaps=-1), "gaps"),
        (lambda: ss.calibrate(BRIDGE, "a.csv", starts=2.5), "starts"),
        (lambda: ss.forecast(BRIDGE, "a.csv", draws=-3), "draws"),
        (lambda: ss.fit_temperature("a.csv", processes="two"), "processes"),
        (lambda: ss.events(xr.Dataset()), "ds"),
        (lambda: ss.run(**RUN, set="friction.static=1.3"), "set"),
        (lambda: ss.check("rho025", set=["friction.static"]), "set"),
        (lambda: ss.run(**RUN, own=len), "own"),
        (lambda: ss.run(**RUN, own={"mine": 3}), "own"),
        (lambda: ss.run(**RUN, inputs=[1.0]), "inputs"),
        (lambda: ss.sweep("rho025", 1.2), "vary"),
        (lambda: ss.sweep("rho025", "friction.static=1:2:3"), "vary"),
        (lambda: ss.sweep("rho025", {"friction.static": 1.2}), "vary"),
        (lambda: ss.plot(xr.Dataset(), labels="rho"), "labels"),
    ],
)
def test_an_argument_that_the_engine_refuses_is_named(call, argument):
    with pytest.raises(ss.ArgumentError) as raised:
        call()
    assert raised.value.argument == argument and raised.value.remedy


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: ss.run("rho025", n=10), "write `paths=`"),
        (lambda: ss.run("rho025", h=0.1), "write `step=`"),
        (lambda: ss.run("rho025", path=10), "write `paths=`"),
        (lambda: ss.Motion("rho025", H=0.1), "Motion() has no such argument\n  fix: write `step=`"),
        (lambda: ss.check("rho025", rho=0.3), 'write `set={"temperature.noise.intensity": ...}`'),
        (lambda: ss.sweep("rho025", {}, fs=1), 'write `set={"friction.static": ...}`'),
        (lambda: ss.load("a.h5", zebra=1), "the arguments are file"),
        (lambda: ss.load(path="a.h5"), "write `file=`"),
        (lambda: ss.plot("rho025", kind="path"), "write `only=`"),
        (lambda: ss.run("rho025", particles=9), "write `paths=`"),
        (lambda: ss.run("rho025", duration=9), "write `until=`"),
        (lambda: ss.run("rho025", cores=9), "write `threads=`"),
    ],
)
def test_an_unknown_argument_gets_a_suggestion(call, words):
    with pytest.raises(ss.ArgumentError) as raised:
        call()
    assert "has no such argument" in str(raised.value) and words in str(raised.value)
    assert raised.value.argument and raised.value.remedy in str(raised.value)


def test_help_names_every_figure_and_record():
    with pytest.raises(ss.ArgumentError) as raised:
        ss.plot("rho025", only="none")
    figures = re.findall(r"[a-z]+(?:-[a-z]+)*", raised.value.problem.split("use one of")[-1])
    assert "tornado" in figures and all(f'"{one}"' in ss.plot.__doc__ for one in figures), figures
    records = re.findall(r"^(\w+) = ", ss.check("rho025").toml.split("[record]")[1].split("[")[0], re.M)
    assert "density" in records
    assert all(f'"{one}"' in ss.run.__doc__ or f"`{one}`" in ss.run.__doc__ for one in records)


def test_a_check_prints_as_the_command_prints_it():
    shown = repr(ss.check("rho025", set={"friction.static": 1.3}))
    assert "[friction]\nstatic = 1.3" in shown and "# natural_frequency = " in shown
    assert "# warning: " in shown and "\\n" not in shown
    assert "None" not in shown and "# friction_ratio = 0.7692307692\n" in shown


def test_a_notebook_shows_a_check_as_a_table():
    shown = ss.check("rho025", set={"title": "<rho>"})._repr_html_()
    table, scenario = shown.split("<details>")
    assert "<h4>&lt;rho&gt;</h4>" in table and "<tr><td>steps</td><td>6000</td></tr>" in table
    assert table.count("<li>") == 2 and "[friction]\nstatic = 1.2" in scenario


def test_a_fitted_temperature_prints_its_numbers_and_its_table():
    time = 600.0 * np.arange(2000)
    noise = np.convolve(np.random.default_rng(1).normal(size=2400), 0.99 ** np.arange(401), "valid")
    fit = ss.fit_temperature((time, 12 + noise), processes=1, periods=[86_400])
    lines = repr(fit).splitlines()
    assert lines[0].startswith("# 2000 samples, mean (1") and lines[0].endswith("degC")
    assert lines[1].startswith("# period 86400 s: amplitude (")
    assert lines[2].startswith("# noise: standard deviation ") and repr(fit).endswith(fit.toml)


def test_a_picture_can_be_pickled():
    picture = ss.plot("rho025", until=5)
    again = pickle.loads(pickle.dumps(picture))
    assert again.svg == picture.svg and again.png() == picture.png()
    assert again.pdf()[:5] == b"%PDF-"
    with pytest.raises(ss.ArgumentError, match="was pickled"):
        again.png(72)


def test_numbers_of_numpy_are_numbers():
    ds = ss.run("rho025", paths=np.int64(300), step=np.float32(0.125), max_time=np.float64(60.0))
    assert ds.attrs["paths"] == 300
    assert ss.replay(ds, np.int64(3)).sizes["path"] == 1


def test_paths_that_diverge_are_no_exception():
    ds = ss.run(
        "rho025",
        paths=256,
        seed=1,
        step=0.1,
        until=400.0,
        bias=False,
        record={"density": True},
        set={"force.expression": "-0.1*x^3", "time.output_step": 20.0},
    )
    assert ds.attrs["completed_paths"] == 256 and ds.attrs["diverged_paths"] > 0


@pytest.mark.parametrize("expression", ["sin(1e6*x)", "sign(sin(1e15*x))"])
@pytest.mark.parametrize("function", ["run", "sweep"])
def test_ctrl_c_ends_a_force_of_fine_structure(expression, function):
    """The bound allows for a machine with other work; the engine needs a third of a second."""

    def interrupt():
        time.sleep(1.0)
        os.kill(os.getpid(), signal.SIGINT)

    arguments = {"scheme": "event-driven", "set": {"force.expression": expression}}
    thread = threading.Thread(target=interrupt)
    thread.start()
    start = time.monotonic()
    with pytest.raises(KeyboardInterrupt):
        if function == "run":
            ss.run("rho025", **arguments)
        else:
            ss.sweep("rho025", {"friction.static": [1.1, 1.2]}, **arguments)
    thread.join()
    assert time.monotonic() - start < 6.0
