"""Compare the file of `mc sweep` with a run at one of its points, without using the arithmetic of
the program.

    target/venv/bin/python tests/python/sweep.py SWEEP.h5 RUN.h5

RUN.h5 is `mc run` at the last point of the sweep, with `record.paths`. Recomputed are the
statistics without each group of paths, from the rows of the run; and the differences of
neighbouring points, their errors by the jackknife, and gains, from the groups.
"""

import sys
import warnings

import numpy as np
import xarray as xr

# 97.5 % of Student's t with 31 degrees of freedom (Abramowitz and Stegun, table 26.10, between 30
# and 40).
STUDENT = 2.0395


def opened(path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        seen = [xr.open_dataset(path, engine=engine).load() for engine in ("h5netcdf", "netcdf4")]
    assert seen[0].equals(seen[1]), "both xarray engines see the same data"
    return seen[0]


def jackknife(values, axis):
    n = values.shape[axis]
    return np.sqrt(
        (n - 1) / n * ((values - values.mean(axis=axis, keepdims=True)) ** 2).sum(axis=axis)
    )


def check_groups(sweep, run, dimensions):
    """The statistics without each group of paths, from the rows of the run."""
    last = sweep.isel({name: -1 for name in dimensions})
    assert float(last.point_completed_paths) == run.sizes["path"]
    duration = float(run.time.max())
    for group in range(32):
        rest = run.isel(path=run.path.values % 32 != group)
        known = last.estimate_without.sel(group=group)
        expected = {
            "displacement_end_mean": float(rest.path_displacement_end.mean()),
            "displacement_end_sd": float(rest.path_displacement_end.std(ddof=1)),
            "sticks_per_path": float(rest.path_sticks.astype(float).mean()),
            "sub_phases_mean": float(rest.path_sub_phases.sum()) / float(rest.path_slips.sum()),
            "sticking_fraction": float(rest.path_stick_time.mean()) / duration,
            "friction_work_mean": float(rest.path_friction_work.mean()),
        }
        for name, value in expected.items():
            there = float(known.sel(statistic=name))
            assert abs(there - value) <= 1e-11 * abs(value), (
                f"{name} without group {group}: {there}, not {value}"
            )


def check_differences(sweep):
    for name in sweep.along.values.tolist():
        at = sweep.sel(along=name)
        n = sweep.sizes[name]
        for i in range(n):
            here = at.isel({name: i})
            if i + 1 == n:
                assert bool(here.difference.isnull().all()), (
                    "there is nothing beyond the last point"
                )
                continue
            pair = sweep.isel({name: i}), sweep.isel({name: i + 1})
            order = [axis for axis in pair[0].estimate_without.dims if axis != "group"] + ["group"]
            without = [p.estimate_without.transpose(*order).values for p in pair]
            difference = (pair[1].estimate - pair[0].estimate).values
            np.testing.assert_allclose(here.difference.values, difference, rtol=1e-12, atol=0)
            errors = [jackknife(values, -1) for values in without]
            error = jackknife(without[1] - without[0], -1)
            known = np.isfinite(here.difference_gain.values)
            assert known.any()
            np.testing.assert_allclose(here.difference_error.values[known], error[known], rtol=1e-6)
            gain = (errors[0] ** 2 + errors[1] ** 2) / error**2
            np.testing.assert_allclose(here.difference_gain.values[known], gain[known], rtol=1e-5)
            reach = ((here.difference_high - here.difference_low) / 2).values
            np.testing.assert_allclose(reach[known], STUDENT * error[known], rtol=1e-4)


def main(sweep_path, run_path):
    sweep, run = opened(sweep_path), opened(run_path)
    assert sweep.attrs["format_name"] == "stick-slip sweep"
    dimensions = sweep.attrs["axes"].split()
    assert set(sweep.dims) == {"statistic", "group", "along", *dimensions}
    for name, variable in sweep.variables.items():
        assert variable.attrs.get("long_name"), f"{name} has a long_name"
    assert sweep.estimate.sel(statistic="stick_duration_mean").dims == tuple(dimensions)
    # The file has a place for every statistic; those that the scenario does not ask for are NaN.
    last = sweep.isel({name: -1 for name in dimensions})
    unasked = ~sweep.statistic.isin(run.statistic)
    assert last.estimate[unasked].isnull().all() and unasked.any()
    last = last.sel(statistic=run.statistic)
    assert (
        last.estimate.values == run.estimate.values
    ).sum() + last.estimate.isnull().sum() == run.sizes["statistic"]
    check_groups(sweep, run, dimensions)
    check_differences(sweep)
    print(f"{sweep_path}: every promise holds")


if __name__ == "__main__":
    main(*sys.argv[1:])
