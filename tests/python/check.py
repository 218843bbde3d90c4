"""Open a file of `mc run` with every reader in common use, and check what docs/output-format.md
says.

    python3 -m venv target/venv
    target/venv/bin/pip install -r tests/python/requirements.txt
    target/venv/bin/python tests/python/check.py FILE.h5 ...

Exits with 1 at the first statement that does not hold, and names it.
"""

import math
import shutil
import subprocess
import sys
import tomllib
import warnings

import h5py
import netCDF4
import numpy as np
import xarray as xr

ROOT_ATTRIBUTES = """Conventions title format_name format_version references source program_version git_hash scheme seed generator paths
    block_size status completed_paths diverged_paths scenario""".split()

# Names, flags and mixed arrays have no unit.
WITHOUT_UNITS = """statistic statistic_long_name statistic_unit estimate standard_error interval_low interval_high bias
    bias_uncertainty bias_order estimate_corrected estimate_corrected_low estimate_corrected_high
    bound law law_long_name law_unit law_lower law_upper law_quantile law_quantile_interval
    cycle cycle_number path_diverged event_sign event_kind trajectory_static""".split()

FLAGS = {
    "event_kind": {0: "stick_entered", 1: "slip_started", 2: "sub_phase_boundary"},
    "event_sign": {-1: "negative", 0: "none", 1: "positive"},
    "path_diverged": {0: "finite", 1: "diverged"},
    "trajectory_static": {0: "dynamic", 1: "static"},
}

# `event` is a dimension without values, and `sub_phase` and `period` count from 1.
BARE_DIMENSIONS = {"event"}


def check(condition, promise):
    if not condition:
        raise AssertionError(promise)


def check_h5py(path):
    """Every axis of every variable has a named scale, text is text, and the seed is an integer."""
    with h5py.File(path) as file:
        for name in ROOT_ATTRIBUTES:
            check(name in file.attrs, f"root attribute {name}")
        check(isinstance(file.attrs["status"], str), "text attributes are str")
        check(isinstance(file.attrs["seed"], np.uint64), "the seed is an unsigned 64-bit integer")
        scales = {name for name, dataset in file.items() if dataset.is_scale}
        for name, dataset in file.items():
            if not dataset.is_scale:
                for axis, dimension in enumerate(dataset.dims):
                    check(len(dimension) == 1, f"{name}: axis {axis} has one scale")
                    check(
                        dimension[0].name.lstrip("/") in scales,
                        f"{name}: axis {axis} is attached to a scale",
                    )
            if dataset.dtype == np.float64 and not dataset.is_scale:
                check(math.isnan(dataset.attrs["_FillValue"]), f"{name}: _FillValue is NaN")
        return int(file.attrs["seed"])


def check_netcdf4(path, seed):
    with netCDF4.Dataset(path) as file:
        check(file.data_model == "NETCDF4", "netCDF-4 data model")
        check(int(file.seed) == seed, "netCDF4 reads the same seed")
        for name, variable in file.variables.items():
            check("phony" not in " ".join(variable.dimensions), f"{name}: named dimensions")
            variable[...]


def check_xarray(path, engine, seed):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with xr.open_dataset(path, engine=engine) as data:
            data.load()
    check(not any("phony" in str(name) for name in data.dims), f"{engine}: named dimensions")
    check(int(data.attrs["seed"]) == seed, f"{engine}: the same seed")
    for name in data.dims:
        check(name in data.coords or name in BARE_DIMENSIONS, f"{engine}: {name} has a coordinate")
    for name, variable in data.variables.items():
        check(variable.attrs.get("long_name"), f"{engine}: {name} has a long_name")
        check(
            ("units" in variable.attrs) == (name not in WITHOUT_UNITS), f"{engine}: units of {name}"
        )
        if name in FLAGS:
            values = [int(value) for value in np.atleast_1d(variable.attrs["flag_values"])]
            flags = dict(zip(values, variable.attrs["flag_meanings"].split(), strict=True))
            check(flags == FLAGS[name], f"{engine}: flags of {name}")
            check(set(np.unique(variable.values)) <= set(flags), f"{engine}: values of {name}")
    return data


def check_contents(data):
    """The numbers of a file agree with each other."""
    attributes = data.attrs
    tomllib.loads(attributes["scenario"])
    check(
        attributes["status"] in ("complete", "ended", "interrupted"),
        "the status of a finished file",
    )
    check(
        (attributes["status"] == "ended") == ("ended_by" in attributes),
        "a run that was ended says by what",
    )
    completed, diverged = int(attributes["completed_paths"]), int(attributes["diverged_paths"])
    check(completed <= attributes["paths"], "no more paths than asked for")
    if attributes["status"] == "complete":
        check(completed == attributes["paths"], "a complete file has every path")
    check(data.sizes.get("diverged_path", 0) == diverged, "every diverged path is listed")

    finite = data.estimate.where(np.isfinite(data.estimate), drop=True).statistic
    known = data.sel(statistic=finite)
    low, high = known.interval_low, known.interval_high
    check(bool(((low <= known.estimate) | low.isnull()).all()), "interval_low <= estimate")
    check(bool(((known.estimate <= high) | high.isnull()).all()), "estimate <= interval_high")
    for name in [name.removesuffix("_interval") for name in data if name.endswith("_interval")]:
        value, interval = data[name], data[f"{name}_interval"]
        low, high = interval.sel(bound="low"), interval.sel(bound="high")
        check(
            bool(((low <= value) & (value <= high) | low.isnull()).all()),
            f"{name} is in its interval",
        )
        check(interval.dims == ("bound", *value.dims), f"{name}: axes of its interval")
        check(value.attrs.get("units") == interval.attrs.get("units"), f"{name}: units of its interval")
    check(bool((np.diff(data.time) > 0).all()), "time increases")
    for name in ("displacement", "velocity", "temperature"):
        steps = np.diff(data[f"{name}_quantile"], axis=0)
        check(
            bool((steps[np.isfinite(steps)] >= 0).all()),
            f"quantiles of {name} increase with their level",
        )
    check(
        bool(((data.static_probability >= 0) & (data.static_probability <= 1)).all()),
        "a probability",
    )
    if "law_bin" in data:
        check(bool((data.law_count.sum("law_bin") == data.law_completed).all()), "every phase is in a bin")
        for law in data.law:
            of = data.sel(law=law).dropna("law_bin")
            check(bool((np.diff(of.law_survival) <= 0).all()), "survival does not rise")
            check(bool((of.law_lower[1:].values == of.law_upper[:-1].values).all()), "bins touch")

    if "path" in data.dims:
        check(data.sizes["path"] == completed, "one row a completed path")
        check(bool((np.diff(data.path.astype(int)) > 0).all()), "path numbers increase")
    if "path_displacement_end" in data:
        good = data.path_diverged.values == 0
        check(int((~good).sum()) == diverged, "diverged paths are marked")
        # Diverged paths are in no statistic.
        mean = math.fsum(data.path_displacement_end.values[good]) / good.sum()
        estimate = float(data.estimate.sel(statistic="displacement_end_mean"))
        scale = max(abs(estimate), float(np.abs(data.path_displacement_end.values[good]).max()))
        check(
            abs(mean - estimate) <= 1e-12 * scale,
            f"mean of the rows {mean} is the estimate {estimate}",
        )
    if "event_count" in data:
        check(
            int(data.event_count.sum()) == data.sizes["event"], "event_count adds up to the events"
        )
        ends = np.cumsum(data.event_count.values.astype(int))
        for times in np.split(data.event_time.values, ends[:-1])[:1000]:
            check(bool((np.diff(times) >= 0).all()), "events of a path are in order of time")
    if "trajectory" in data.dims:
        check(data.trajectory_displacement.dims == ("trajectory", "time"), "axes of a trajectory")


def check_trade(path):
    """In the file of `mc trade` every reader sees the same named axes, and the predictions agree
    with the measurements."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        seen = [xr.open_dataset(path, engine=engine).load() for engine in ("h5netcdf", "netcdf4")]
    check(seen[0].equals(seen[1]), "both xarray engines see the same data")
    data = seen[0]
    check(set(data.dims) == {"rung", "statistic", "scheme", "target"}, "the dimensions of a trade")
    for name, variable in data.variables.items():
        check(variable.attrs.get("long_name"), f"{name} has a long_name")
    target = data.predicted_bias.where(data.predicted_seconds.notnull()) < data.target
    check(
        bool((target | data.predicted_bias.isnull()).all()),
        "no recommended run has a bias above its target",
    )
    cheapest = data.predicted_seconds.min("scheme")
    check(
        bool(((data.winner == "none") == cheapest.isnull()).all()),
        "there is a winner where there is a run",
    )


def check_command(*command):
    if shutil.which(command[0]) is None:
        print(f"  skipped {command[0]}: not installed")
        return
    result = subprocess.run(command, capture_output=True, text=True)
    check(result.returncode == 0 and not result.stderr, f"{' '.join(command)}: {result.stderr}")
    check("phony" not in result.stdout, f"{command[0]}: named dimensions")


def main(paths):
    for path in paths:
        print(path)
        with h5py.File(path) as file:
            is_trade = file.attrs["format_name"] == "stick-slip trade"
        if is_trade:
            check_trade(path)
            continue
        seed = check_h5py(path)
        check_netcdf4(path, seed)
        seen = [check_xarray(path, engine, seed) for engine in ("h5netcdf", "netcdf4")]
        check(seen[0].equals(seen[1]), "both xarray engines see the same data")
        check_contents(seen[0])
        check_command("ncdump", "-h", path)
        check_command("h5dump", "-H", path)
    print("every promise holds")


if __name__ == "__main__":
    if len(sys.argv) < 2:
        sys.exit(__doc__)
    try:
        main(sys.argv[1:])
    except AssertionError as error:
        sys.exit(f"broken promise: {error}")
