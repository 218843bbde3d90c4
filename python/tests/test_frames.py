"""Events and statistics as data frames of pandas."""

from __future__ import annotations

import math
import pickle
import re
import sys

import numpy as np
import pytest
import stickslip as ss

pytest.importorskip("pandas")
pytestmark = pytest.mark.filterwarnings("ignore::stickslip.StickSlipWarning")


def test_a_frame_of_events_has_a_row_for_each():
    ds = ss.run("rho025", paths=300, record="events", bias=False, set={"units.time": "h"})
    frame = ss.events(ds)
    assert len(frame) == ds.sizes["event"]
    assert list(frame) == ["path", "time", "displacement", "force", "sign", "kind"]
    counted = frame.groupby("path").size().reindex(range(300), fill_value=0)
    assert counted.to_numpy().tolist() == ds.event_count.to_numpy().tolist()
    assert frame.time.to_numpy().tobytes() == ds.event_time.to_numpy().tobytes()
    # A path begins its sticks as often as its own numbers say.
    begun = frame[frame.kind == "stick_entered"].groupby("path").size()
    assert (begun - ds.path_sticks.to_series().reindex(begun.index)).abs().max() <= 1
    assert frame.attrs["units"]["time"] == "h"


def test_events_of_a_part_keep_the_path_numbers():
    ds = ss.run("rho025", paths=512, bias=False, record="events")
    whole = ss.events(ds)
    alone = ss.events(ss.replay(ds, 300))
    assert set(alone.path) == {300}
    assert alone.time.tolist() == whole[whole.path == 300].time.tolist()
    part = ss.events(ss.run("rho025", paths=512, bias=False, record="events", part="2/2"))
    assert part.equals(whole[whole.path >= 256].reset_index(drop=True))


def test_a_data_set_without_events_has_no_frame():
    ds = ss.run("rho025", paths=256, bias=False, record="events")
    with pytest.raises(ss.ArgumentError, match='record="events"'):
        ss.events(ds.drop_dims("event"))
    with pytest.raises(ss.ArgumentError, match="select rows of the frame"):
        ss.events(ds.sel(path=slice(0, 9)))


def test_a_summary_has_a_row_for_each_statistic():
    ds = ss.run("rho025", paths=20_000, own={"events": lambda events: events.count})
    frame = ss.summary(ds)
    assert list(frame.index) == [*ds.statistic.values, "events"]
    assert list(frame)[:5] == [
        "estimate",
        "standard_error",
        "interval_low",
        "interval_high",
        "bias",
    ]
    first = frame.loc["stick_duration_mean"]
    known = ds.sel(statistic="stick_duration_mean")
    for name in ("estimate", "bias", "estimate_corrected", "estimate_corrected_low"):
        assert first[name] == known[name].item()
    assert first.unit == "1" and first.long_name == "mean duration of the completed sticks"
    assert frame.loc["events", "estimate"] == ds.own_estimate.item()
    assert np.isnan(frame.loc["events", "bias"])


def test_a_summary_of_a_run_without_bias_has_the_same_columns():
    without = ss.summary(ss.run("rho025", paths=256, bias=False))
    assert list(without) == list(ss.summary(ss.run("rho025", paths=20_000)))
    assert without.estimate_corrected.isna().all()


def test_a_summary_of_a_sweep_has_its_axes_in_the_index():
    values = [1.1, 1.2, 1.5]
    sweep = ss.sweep("rho025", {"friction.static": values}, paths=256)
    frame = ss.summary(sweep)
    assert frame.index.names == ["f_s", "statistic"]
    point = sweep.sel(f_s=1.2, statistic="stick_duration_mean")
    assert frame.loc[(1.2, "stick_duration_mean"), "estimate"] == point.estimate.item()
    star = ss.sweep("rho025", elasticity="friction.static", paths=256)
    assert len(ss.summary(star)) == star.sizes["point"] * star.sizes["statistic"]


def test_what_has_no_statistics_has_no_summary():
    import xarray as xr

    with pytest.raises(ss.ArgumentError, match="no statistics"):
        ss.summary(xr.Dataset())


def test_without_pandas_the_message_says_so(monkeypatch):
    ds = ss.run("rho025", paths=256, bias=False)
    monkeypatch.setitem(sys.modules, "pandas", None)
    for frame in (ss.events, ss.summary):
        with pytest.raises(ModuleNotFoundError, match="pip install pandas"):
            frame(ds)


def test_a_summary_writes_latex_with_digits_and_units():
    ds = ss.run("rho025", paths=512, bias=False, set={"units.time": "s", "units.length": "m"})
    frame = ss.summary(ds)
    lines = frame.to_latex().splitlines()
    assert lines[3].startswith("statistic & estimate & 95") and len(lines) == len(frame) + 7
    row = frame.loc["stick_duration_mean"]
    shown = next(line for line in lines if line.startswith("mean duration of the completed sticks &"))
    numbers = [float(x) for x in re.findall(r"\$([-\d.]+)\$", shown)]
    assert shown.endswith(r"& $\mathrm{s}$ \\")
    assert numbers == pytest.approx([row.estimate, row.interval_low, row.interval_high], rel=1e-3)
    # Two digits of the standard error.
    decimals = 1 - math.floor(math.log10(row.standard_error))
    assert all(len(x.split(".")[1]) == decimals for x in re.findall(r"\$([-\d.]+)\$", shown))
    assert r"\mathrm{m^{2}\,s^{-1}}" in frame.loc[["diffusion_coefficient"]].to_latex()
    assert pickle.loads(pickle.dumps(frame)).to_latex() == frame.to_latex()
    swept = ss.sweep("rho025", {"friction.static": [1.1, 1.2]}, paths=256, bias=False)
    assert ss.summary(swept).to_latex().count("& mean duration of the completed sticks &") == 2
