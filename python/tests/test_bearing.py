"""Calibrations, forecasts, fits of a temperature and synthetic measurements have the numbers of the
command."""

from __future__ import annotations

import csv
import dataclasses
import json

import numpy as np
import pytest
import stickslip as ss
from conftest import ROOT, same

pytestmark = pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")

BRIDGE = ROOT / "examples/bridge/bridge.toml"
BEARING = ROOT / "examples/bridge/bearing.toml"
TWIN = ROOT / "examples/bridge/twin.csv"


def test_calibrate(mc, tmp_path):
    mc("calibrate", BRIDGE, TWIN, "--starts", 2, "-o", "fit.h5")
    file, mine = ss.load(tmp_path / "fit.h5"), ss.calibrate(BRIDGE, TWIN, starts=2)
    same(mine, file)
    mc("plot", "fit.h5", "-o", "fit.svg")
    assert ss.plot(mine).svg == (tmp_path / "fit.svg").read_text()
    # The measurement from memory has the same estimates. It was repaired and thinned already.
    time = file.time.to_numpy()
    again = ss.calibrate(
        BRIDGE, (time, file.temperature.to_numpy()), (time, file.displacement.to_numpy()), starts=2
    )
    np.testing.assert_allclose(again.estimate, file.estimate, rtol=1e-6)


def test_calibrate_refuses_in_the_words_of_the_command(mc, tmp_path):
    with pytest.raises(ss.ArgumentError, match="not a parameter"):
        ss.calibrate(BRIDGE, TWIN, fit=["friction.sttic"])
    for data, arguments, flags in [
        ("none.csv", {}, []),
        (TWIN, {"displacement": "gauge"}, ["--displacement", "gauge"]),
        (TWIN, {"layout": ss.Layout(displacement_unit="mile")}, ["--displacement-unit", "mile"]),
        (
            TWIN,
            {"layout": ss.Layout(temperature_file="none.csv")},
            ["--temperature-file", "none.csv"],
        ),
    ]:
        _, said = mc("calibrate", BRIDGE, data, *flags, succeeds=False)
        with pytest.raises(ss.ArgumentError) as raised:
            ss.calibrate(BRIDGE, data, **arguments)
        assert f"{raised.value.problem}" in said and raised.value.remedy.split(": ")[-1] in said, said
    for arguments, word in [
        ({"fit": ["friction.static"]}, "initial.displacement"),
        ({"method": "magic"}, "slips, criterion or both"),
        ({"interval": 2}, "0.5 and 0.999"),
        ({"starts": 0}, "1 and 1000"),
        ({"lag": -1}, "positive duration"),
    ]:
        with pytest.raises(ss.ArgumentError, match=word):
            ss.calibrate(BRIDGE, TWIN, **arguments)


def test_an_argument_says_that_samples_are_means(mc, tmp_path):
    mc("calibrate", BRIDGE, TWIN, "--averaged", "10min", "--method", "slips", "-o", "fit.h5")
    means = ss.calibrate(BRIDGE, TWIN, layout=ss.Layout(averaged="10min"), method="slips")
    # The title lists the flag, which is an argument here.
    same(means, ss.load(tmp_path / "fit.h5").assign_attrs(title=means.title))
    samples = ss.calibrate(BRIDGE, TWIN, layout=ss.Layout(averaged=0), method="slips")
    same(samples, ss.calibrate(BRIDGE, TWIN, method="slips"))
    # The extremes of an instant are farther apart than those of means.
    f_s = "friction.static"
    assert means.estimate.sel(quantity=f_s) > 1.01 * samples.estimate.sel(quantity=f_s)
    with pytest.raises(ss.ArgumentError, match="averaged"):
        ss.Layout(averaged="an hour")
    mc("fit-temperature", TWIN, "--averaged", "10min", "-o", "weather.toml")
    weather = ss.fit_temperature(TWIN, layout=ss.Layout(averaged="10min")).toml
    assert (tmp_path / "weather.toml").read_text().endswith(weather)
    assert weather != ss.fit_temperature(TWIN).toml


def test_a_data_frame_and_two_files_are_the_file(mc, tmp_path):
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_csv(TWIN)
    by_file = ss.calibrate(BRIDGE, TWIN, method="slips")
    same(ss.calibrate(BRIDGE, frame, method="slips"), by_file)
    dated = frame.assign(time=pandas.to_datetime(frame.time)).set_index("time")
    same(ss.calibrate(BRIDGE, dated, method="slips"), by_file)
    # Columns are read in the unit that their names give, and errors name the line.
    metres = frame.assign(displacement_m=frame.displacement_mm / 1000).drop(
        columns="displacement_mm"
    )
    np.testing.assert_allclose(
        ss.calibrate(BRIDGE, metres, method="slips").estimate, by_file.estimate, rtol=1e-9
    )
    with pytest.raises(
        ss.ArgumentError, match='the DataFrame:12: `displacement_mm` = "far" is not a number'
    ):
        ss.calibrate(
            BRIDGE,
            frame.astype({"displacement_mm": object}).replace(
                {"displacement_mm": {frame.displacement_mm[10]: "far"}}
            ),
        )
    frame[["time", "temperature_degC"]].to_csv(tmp_path / "t.csv", index=False)
    frame[["time", "displacement_mm"]][1008:].to_csv(tmp_path / "z.csv", index=False)
    layout = ss.Layout(temperature_file=tmp_path / "t.csv")
    two = ss.calibrate(BRIDGE, tmp_path / "z.csv", layout=layout, method="slips")
    # A sensor that was mounted a week later: as files, and as series with dates, which have the
    # same clock.
    temperature = dated.temperature_degC
    later = dated.displacement_mm[1008:] / 1000
    by_series = ss.calibrate(BRIDGE, temperature, later, method="slips")
    np.testing.assert_allclose(by_series.estimate, two.estimate, rtol=1e-9)
    np.testing.assert_allclose(by_series.slip_time, two.slip_time)
    with pytest.raises(ss.ArgumentError, match="dates cannot be combined with numbers"):
        ss.calibrate(BRIDGE, temperature, (np.arange(300.0), np.arange(300.0)))


def test_masked_values_are_missing_as_nan_is():
    with open(TWIN) as file:
        rows = [row for row in csv.reader(file) if not row[0].startswith("#")]
    table = np.array([[float(x or "nan") for x in row[1:3]] for row in rows[1:]]).T
    time = 600.0 * np.arange(table.shape[1])
    names = rows[0][1:3]
    scale = 1e-3 if any("mm" in name for name in names) else 1.0
    order = 0 if "temp" in names[0] else 1
    temperatures, readings = table[order], table[1 - order] * scale
    # A sensor that says 60 degrees where it fails, and its user masks these values.
    is_off = np.zeros(len(time), dtype=bool)
    is_off[100::37] = True
    spoilt = np.where(is_off, 60.0, temperatures)
    arguments = {"method": "slips"}
    masked = ss.calibrate(
        BRIDGE, (time, np.ma.array(spoilt, mask=is_off)), (time, readings), **arguments
    )
    without = ss.calibrate(BRIDGE, (time[~is_off], temperatures[~is_off]), (time, readings), **arguments)
    as_nan = ss.calibrate(
        BRIDGE, (time, np.where(is_off, np.nan, temperatures)), (time, readings), **arguments
    )
    same(masked, without, but=("repairs",))
    same(masked, as_nan)
    moved = np.where(is_off, 1.0, readings)
    with_masked_readings = ss.calibrate(
        BRIDGE, (time, temperatures), (time, np.ma.array(moved, mask=is_off)), **arguments
    )
    same(
        with_masked_readings,
        ss.calibrate(BRIDGE, (time, temperatures), (time[~is_off], readings[~is_off]), **arguments),
        but=("repairs",),
    )
    weather = ss.fit_temperature((time, np.ma.array(spoilt, mask=is_off)), periods=[86_400])
    assert weather == ss.fit_temperature((time[~is_off], temperatures[~is_off]), periods=[86_400])


def test_arrays_and_tables_have_the_same_repairs():
    pandas = pytest.importorskip("pandas")
    twin = pandas.read_csv(TWIN, comment="#")
    time = 600.0 * np.arange(len(twin))
    temperatures = twin.temperature_degC.to_numpy(copy=True)
    readings = twin.displacement_mm.to_numpy() / 1000
    # A sensor that is silent 78 times, and wrong twice.
    temperatures[100::55][:78] = np.nan
    temperatures[[1001, 2002]] = 9999.9
    frame = pandas.DataFrame(
        {"time_s": time, "temperature_degC": temperatures, "displacement_m": readings}
    )
    silent = int(np.isnan(temperatures).sum())

    def said(work):
        with pytest.warns(ss.StickSlipWarning) as issued:
            result = work()
        return result, " ".join(str(warning.message) for warning in issued)

    strict = ss.Layout(outliers=8)
    named = ss.Layout(time="time_s", temperature="temperature_degC", outliers=8)
    by_array, of_array = said(
        lambda: ss.calibrate(
            BRIDGE, (time, temperatures), (time, readings), method="slips", layout=strict
        )
    )
    by_frame, of_frame = said(
        lambda: ss.calibrate(BRIDGE, frame, layout=named, method="slips")
    )
    same(by_array, by_frame, but=("repairs",))
    of_both = [of_array, of_frame, by_array.attrs["repairs"], by_frame.attrs["repairs"]]
    for words in of_both:
        assert f"left out {silent} cells without a value in `temperature" in words, words
        assert "left out 2 outliers" in words, words
    weather, of_weather = said(
        lambda: ss.fit_temperature((time, temperatures), processes=1, layout=strict)
    )
    again, _ = said(lambda: ss.fit_temperature(frame, processes=1, layout=named))
    assert weather == again and "left out 2 outliers" in of_weather
    # Nothing is left out that nobody asked for.
    _, of_record = said(lambda: ss.fit_temperature((time, temperatures), processes=1))
    assert "9999.9 in line 1002" in of_record
    with pytest.raises(ss.ArgumentError, match="given for dates|plain number"):
        ss.calibrate(BRIDGE, frame, layout=ss.Layout(time="time_s", zone="UTC"))
    with pytest.raises(ss.ArgumentError, match=r"layout\.zone = UTC: it applies to files"):
        ss.calibrate(BRIDGE, (time, temperatures), (time, readings), layout=ss.Layout(zone="UTC"))


def test_forecast(mc, tmp_path):
    few = ["--draws", 4, "--years", 3, "--seed", 5, "--interval", 0.8, "--share", 0.7]
    told = json.loads(mc("forecast", BEARING, TWIN, *few, "--json", "-o", "years.csv")[0])
    mine = ss.forecast(BEARING, TWIN, draws=4, years=3, seed=5, interval=0.8, share=0.7)
    names = list(mine.quantity.to_numpy())
    assert told["attrs"]["interval"] == mine.attrs["interval"] == 0.8 and mine.attrs["share"] == 0.7
    for kind in ("coords", "data_vars"):
        for name, variable in told[kind].items():
            assert mine[name].to_numpy().tolist() == variable["data"], name
    rows = list(csv.DictReader((tmp_path / "years.csv").open()))
    assert len(rows) == mine.sizes["draw"] * mine.sizes["year"] == 12
    for row in rows:
        year = mine.sel(draw=int(row.pop("draw")), year=int(row.pop("year")))
        for column, value in row.items():
            name = next(
                name for name in names if column in (name, f"{name}_m", f"{name}_N")
            )
            assert year[name].item() == float(value), column
    # Without K_BP there are no forces.
    soft = BEARING.read_text().replace("stiffness = 2.0e9\n", "")
    assert "force_abs_max" not in ss.forecast(soft, TWIN, draws=2, years=2)


def test_a_forecast_that_cannot_be_says_what_to_measure():
    pandas = pytest.importorskip("pandas")
    frame = pandas.read_csv(TWIN)
    with pytest.raises(ss.RunError) as raised:
        ss.forecast(BEARING, frame[: 90 * 144])
    assert "half a period" in raised.value.problem and "half a year" in raised.value.remedy
    still = ss.twin(BRIDGE, set={"friction.static": 1e9, "friction.dynamic": 9e8})
    with pytest.raises(ss.RunError) as raised:
        ss.forecast(BEARING, still.temperature, still.displacement)
    assert "no slips" in raised.value.problem and "measure for longer" in raised.value.remedy
    for arguments, argument in [
        ({"draws": 1}, "draws"),
        ({"processes": 3}, "processes"),
    ]:
        with pytest.raises(ss.ArgumentError) as wrong:
            ss.forecast(BEARING, TWIN, **arguments)
        assert wrong.value.argument == argument


@pytest.mark.parametrize("processes", [1, 2])
def test_fit_temperature(processes, mc, tmp_path):
    told = json.loads(
        mc("fit-temperature", TWIN, "--processes", processes, "--json", "-o", "weather.toml")[0]
    )
    mine = ss.fit_temperature(TWIN, processes=processes)
    numbers = dataclasses.asdict(mine)
    toml, table, start = (numbers.pop(name) for name in ("toml", "temperature", "start"))
    # The first members of a JSON object of the command say which program printed it.
    assert (
        told.pop("document") == "weather"
        and told.pop("schema_version") == 1
        and told.pop("program")["name"] == "mc"
        and told.pop("warnings") == []
        and told.pop("repairs") == []
    )
    assert numbers == told
    part = (tmp_path / "weather.toml").read_text()
    assert part.endswith(toml) and f"t = 0 is {start}." in part
    # As text and as a dictionary it makes the same scenario with a bearing.
    import tomllib

    by_text = ss.check(BEARING.read_text() + toml)
    by_table = ss.check({**tomllib.loads(BEARING.read_text()), "temperature": table})
    assert by_text.toml == by_table.toml
    # Arrays give the same.
    file = ss.calibrate(BRIDGE, TWIN, method="slips")
    times, temperatures = file.time.to_numpy(), file.temperature.to_numpy()
    by_arrays = ss.fit_temperature((times, temperatures), processes=processes)
    np.testing.assert_allclose(by_arrays.mean, mine.mean, rtol=1e-3)


def test_what_cannot_be_fitted_is_refused():
    for arguments, argument in [
        ({"periods": [86_400, 86_400.0]}, "periods"),
        ({"periods": [0]}, "periods"),
        ({"processes": 0}, "processes"),
        ({"layout": ss.Layout(temperature="air")}, "data"),
        ({"layout": ss.Layout(time="when")}, "data"),
    ]:
        with pytest.raises(ss.ArgumentError) as raised:
            ss.fit_temperature(TWIN, **arguments)
        assert raised.value.argument == argument and raised.value.remedy
    with pytest.raises(ss.RunError, match="need at least 100 samples"):
        ss.fit_temperature((np.arange(5.0), np.arange(5.0)))


TWINS = {
    "drawn": ({"seed": 3}, ["--seed", 3]),
    "with every flaw": (
        {
            "seed": 4,
            "sensor_noise": (50e-6, 200e-6, 2 * 86_400),
            "scatter": 0.05,
            "lag": 900,
            "resolution": 0.5,
            "spikes": 0.001,
            "gaps": 4,
            "drift": 0.5e-3,
            "zero_set": (20 * 86_400, -1e-3),
            "set": {"friction.static": 5e5},
        },
        [
            "--seed",
            4,
            "--sensor-noise",
            "50e-6,200e-6,2d",
            "--scatter",
            0.05,
            "--lag",
            "15m",
            "--resolution",
            0.5,
            "--spikes",
            0.001,
            "--gaps",
            4,
            "--drift",
            0.5e-3,
            "--zero-set",
            "20d:-1e-3",
            "--set",
            "friction.static=5e5",
        ],
    ),
}


@pytest.mark.parametrize("scenario", ["bridge", "viaduct-drawn"])
@pytest.mark.parametrize("name", TWINS)
def test_twin(name, scenario, mc, tmp_path):
    """A file has three and five decimals, so its numbers are those in memory after rounding."""
    arguments, flags = TWINS[name]
    path = BRIDGE if scenario == "bridge" else tmp_path / "year.toml"
    if scenario != "bridge":
        path.write_text(BEARING.read_text() + ss.fit_temperature(TWIN).toml)
    printed, said = mc("twin", path, *flags, "-o", "twin.csv")
    mine = ss.twin(path, **arguments)
    rows = list(csv.reader((tmp_path / "twin.csv").open()))[1:]
    assert [row[1] for row in rows] == [f"{value:.3f}" for value in mine.temperature.to_numpy()]
    assert [row[2] for row in rows] == [
        f"{1e3 * value:.5f}" for value in mine.displacement.to_numpy()
    ]
    assert f"{mine.attrs['slips']} slips" in said.replace(" ", " ")
    assert rows[0][0].startswith(mine.attrs["start"][:16])
    seconds = np.array([row[0].rstrip("Z") for row in rows], dtype="datetime64[s]")
    assert (
        (seconds - seconds[0]).astype(float) == mine.time.to_numpy() - mine.time.to_numpy()[0]
    ).all()
    for line in printed.splitlines():
        key, *_, value = line.split()
        assert float(value) == pytest.approx(mine.truth.sel(quantity=key).item(), rel=1e-6), key


def test_a_twin_is_calibrated_to_its_truth():
    """The estimates are within 10 % of the truth, which is five standard errors."""
    mine = ss.twin(BRIDGE, seed=4, set={"friction.static": 4.2e5, "friction.dynamic": 3.6e5})
    found = ss.calibrate(BRIDGE, mine.temperature, mine.displacement, method="slips")
    for key in (
        "friction.static",
        "friction.dynamic",
        "oscillator.stiffness",
        "oscillator.dilatation",
    ):
        one = found.sel(quantity=key).estimate.item()
        assert one == pytest.approx(mine.truth.sel(quantity=key).item(), rel=0.1), key
    for arguments, argument in [
        ({"scatter": -0.1}, "scatter"),
        ({"spikes": 0.6}, "spikes"),
        ({"gaps": -1}, "gaps"),
        ({"every": 0}, "every"),
        ({"duration": 100, "every": 100}, "duration"),
        ({"sensor_noise": (-1,)}, "sensor_noise"),
    ]:
        with pytest.raises(ss.ArgumentError) as raised:
            ss.twin(BRIDGE, **arguments)
        assert raised.value.argument == argument


def test_the_shipped_bridge_has_its_temperature_with_it(monkeypatch, tmp_path):
    from_file = ss.twin(ROOT / "scenarios/bridge.toml", seed=3)
    monkeypatch.chdir(tmp_path)
    same(ss.twin("bridge", seed=3), from_file)
