"""Many runs, one question: sweeps, the trade, calibration."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

from . import _native, _toml
from ._check import scenario_flags
from ._data import dataset, ready, warn
from ._progress import Progress, shown
from ._scenario import ScenarioLike, Settings, parse, samples, source
from .errors import wrong_argument

if TYPE_CHECKING:
    import xarray as xr

#: Values of a key: numbers, or "START:STOP:COUNT" or "log:START:STOP:COUNT".
Values = Union[str, Sequence[float], Any]


def sweep(
    scenario: ScenarioLike,
    vary: Mapping[str, Values] | None = None,
    *,
    zip: bool = False,
    elasticity: str | Sequence[str] = (),
    relative_step: float = 0.05,
    independent: bool = False,
    paths: int | None = None,
    seed: int | None = None,
    scheme: str | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    until: float | None = None,
    set: Settings | None = None,
    temperature: Any = None,
    bias: bool = True,
    threads: int | None = None,
    progress: Progress = None,
) -> xr.Dataset:
    """Statistics as functions of keys of the scenario, like `mc sweep`.

    All points see the same noise, which makes differences between neighbours sharp.

    Args:
        scenario: as for `run`.
        vary: values of each key: `{"temperature.noise.intensity": np.linspace(0, 1, 21)}`. The dimension is called by the symbol of
            the key; "rho=temperature.noise.intensity" calls it rho. Several keys are crossed.
        zip: let the first values of all keys go together, then the second ones, and so on.
        elasticity: keys instead of `vary`: by what share each statistic changes for each share by which these keys do.
        relative_step: the step to both sides of each key, for `elasticity`.
        independent: give every point a seed of its own.
        paths, seed, scheme, step, tolerance, until, set, temperature, bias, threads, progress: as for `run`.

    Returns:
        Estimates with intervals and biases along the dimensions of the sweep and `statistic`, and differences of neighbours, or
        elasticities. After Ctrl-C `point_status` says which points are done.

    Raises:
        ScenarioError: something in the scenario, or at a point of the sweep, is wrong.
        ArgumentError: an argument is wrong.
    """
    ready()
    keys = [elasticity] if isinstance(elasticity, str) else list(elasticity)
    if bool(vary) == bool(keys):
        raise wrong_argument("vary", vary, "either keys are varied, or elasticities are asked for", "give one of them")
    parsed = parse(scenario, set, scenario_flags(paths, seed, scheme, step, tolerance, until), temperature)
    with shown(progress) as told:
        made, is_interrupted = _native.sweep(
            parsed,
            vary=[f"{key}={_values(key, values)}" for key, values in (vary or {}).items()],
            zip=zip,
            elasticity=keys,
            relative_step=relative_step,
            independent=independent,
            bias=bias,
            workers=threads,
            progress=told,
        )
    warn(["interrupted: the points that are missing are NaN"] if is_interrupted else [])
    return dataset(made)


def trade(
    scenario: ScenarioLike,
    *,
    budget: float = 30.0,
    seed: int | None = None,
    set: Settings | None = None,
    temperature: Any = None,
    threads: int | None = None,
) -> xr.Dataset:
    """What accuracy costs, like `mc trade`: every scheme over a ladder of steps or tolerances, measured on this machine.

    Args:
        scenario, seed, set, temperature, threads: as for `run`.
        budget: seconds to measure for.

    Returns:
        Bias, variance and CPU time of each `rung`, orders of the schemes, and for each `scheme`, `statistic` and `target` the
        cheapest run that is predicted to meet it.

    Raises:
        RunError: the budget is too small, or there is nothing to compare.
    """
    ready()
    parsed = parse(scenario, set, scenario_flags(None, seed, None, None, None, None), temperature)
    made, is_interrupted = _native.trade(parsed, float(budget), threads)
    warn(["interrupted: what was measured until then is told"] if is_interrupted else [])
    return dataset(made)


def calibrate(
    scenario: ScenarioLike,
    data: Any,
    displacement: Any = None,
    *,
    method: str = "both",
    fit: Sequence[str] = (),
    bounds: Mapping[str, tuple[float, float]] | None = None,
    starts: int = 10,
    lag: float | None = None,
    interval: float = 0.9,
    unit: str | None = None,
    set: Settings | None = None,
    threads: int | None = None,
) -> xr.Dataset:
    """Friction, stiffness and dilatation of a bearing from its measured temperature and displacement, like `mc calibrate`.

    Args:
        scenario: K_BP, where a search begins, and the columns of the data. It needs no `[time]`.
        data: a CSV file; or measured temperatures along time in K, as a pandas Series, a DataArray or a pair (times, values), with
            times in seconds or dates.
        displacement: of a CSV file, the column of displacements; else measured displacements along time, in m.
        method: "slips", the paper's least squares "err", or "both".
        fit: keys of the parameters to fit; the others are held at what the scenario says. All if not given.
        bounds: between which values the least squares look for a parameter.
        starts: how many starts the least squares have.
        lag: seconds by which steel is behind the thermometer; estimated if not given.
        interval: the probability with which an interval is to hold the truth, from 0.5 to 0.999.
        unit: of displacements in a CSV file, if the name of their column does not say it: m, cm, mm or um.
        set: as for `run`.
        threads: as for `run`.

    Returns:
        Estimates with intervals along `quantity`, the slips that were seen, the record, and what the model makes of it.

    Raises:
        ScenarioError: something in the scenario is wrong.
        ArgumentError: an argument, or something in the data, is wrong.
        RunError: the record does not tell the parameters.
    """
    if not 0.5 <= interval <= 0.999:
        raise wrong_argument("interval", interval, "it is no probability of an interval", "give 0.5 to 0.999")
    if not 1 <= starts <= 1000:
        raise wrong_argument("starts", starts, "so many starts are none, or too many", "give 1 to 1000")
    name, text = source(scenario)
    is_file = isinstance(data, (str, os.PathLike))
    arrays = None
    if not is_file:
        if displacement is None:
            raise wrong_argument("displacement", None, "the temperatures come without displacements", "give both")
        (times, temperatures, _), (when, readings, _) = samples(data), samples(displacement, "displacement")
        arrays = [times, temperatures, when, readings]
    made, remarks = _native.calibrate(
        name,
        text,
        [(key, _toml.value(key, given)) for key, given in (set or {}).items()],
        os.fspath(data) if is_file else None,
        arrays,
        method=method,
        fit=list(fit),
        bounds=[(key, float(low), float(high)) for key, (low, high) in (bounds or {}).items()],
        starts=starts,
        lag=lag,
        interval=interval,
        displacement=displacement if is_file else None,
        unit=unit,
        workers=threads,
    )
    warn(remarks)
    return dataset(made)


def _values(key: str, values: Values) -> str:
    return values if isinstance(values, str) else ",".join(_toml.value(key, float(value)) for value in values)
