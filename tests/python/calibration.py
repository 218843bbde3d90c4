"""Compare the file of `mc calibrate` with the model, computed independently here.

calibration.py FIT.h5
"""

import math
import sys

import numpy as np
import xarray as xr


def follow(reach, jump, start, temperatures):
    """xi at each temperature, slip by slip, as the paper defines it."""
    xi, out = start, []
    for temperature in temperatures:
        while abs(temperature - xi) > reach:
            xi += math.copysign(jump, temperature - xi)
        out.append(xi)
    return np.array(out)


def modelled(values, steel):
    """z of a bearing with these parameters."""
    at = dict(zip(values.quantity.values, values.values))
    beta, kappa = at["oscillator.dilatation"], at["bearing.shear"]
    xi = follow(at["reach"], at["jump"], at["initial.displacement"] / beta, steel)
    return at["bearing.offset"] + (1 - kappa) * beta * xi + kappa * beta * steel


def main(path):
    fit = xr.open_dataset(path, engine="h5netcdf")
    assert fit.attrs["format_name"] == "stick-slip calibration"
    for name, variable in fit.variables.items():
        assert variable.attrs.get("long_name"), f"{name} has a long_name"
    steel, measured = fit.steel_temperature.values, fit.displacement.values
    model = modelled(fit.estimate, steel)
    np.testing.assert_allclose(fit.displacement_modelled.values, model, rtol=0, atol=1e-9)
    left = (measured - model)[np.isfinite(measured)]
    np.testing.assert_allclose(fit.attrs["residual_rms"], np.sqrt((left**2).mean()), rtol=1e-9)
    # Samples are evenly spaced here, so that each stands for the same time.
    for start in range(fit.sizes["start"]):
        left = (measured - modelled(fit.start_value.isel(start=start), steel))[
            np.isfinite(measured)
        ]
        np.testing.assert_allclose(fit.start_err.values[start], (left**2).mean(), rtol=1e-3)
    at = dict(zip(fit.quantity.values, fit.estimate.values))
    slope = at["oscillator.stiffness"] * at["oscillator.dilatation"]
    for key, value in {
        "friction.gap": at["friction.static"] - at["friction.dynamic"],
        "bearing.shear": at["oscillator.stiffness"] / fit.attrs["shear_stiffness"],
        "reach": at["friction.static"] / slope,
        "jump": 2 * at["friction.gap"] / slope,
        "static_way": at["friction.static"] / at["oscillator.stiffness"],
        "dynamic_way": at["friction.dynamic"] / at["oscillator.stiffness"],
    }.items():
        np.testing.assert_allclose(at[key], value, rtol=1e-9, err_msg=key)
    assert bool(((fit.interval_low < fit.estimate) & (fit.estimate < fit.interval_high)).all())
    correlation = fit.correlation.values
    np.testing.assert_allclose(correlation, correlation.T, atol=1e-12)
    np.testing.assert_allclose(np.diag(correlation), 1, atol=1e-12)
    assert (np.diff(fit.slip_time.values) > 0).all()
    print(f"{path}: every promise holds")


if __name__ == "__main__":
    main(*sys.argv[1:])
