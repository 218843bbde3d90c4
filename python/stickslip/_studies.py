"""Studies of many runs: sweeps and trades."""

from __future__ import annotations

import os

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

from . import _native, _own, _toml
from ._data import dataset, ready, warn
from ._own import Statistic
from ._progress import Progress, shown
from ._public import public
from ._scenario import ScenarioLike, Scheme, Settings, parse
from ._time import Time, seconds
from .errors import mappings, require

if TYPE_CHECKING:
    import xarray as xr

#: Values of a key: numbers, names of files, or a text "START:STOP:COUNT" or "log:START:STOP:COUNT".
Values = Union[str, Sequence[float], Sequence[str], Any]


@public
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
    scheme: Scheme | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    until: float | None = None,
    set: Settings | None = None,
    temperature: Any = None,
    inputs: Mapping[str, Any] | None = None,
    bias: bool = True,
    own: Mapping[str, Statistic] | None = None,
    threads: int | None = None,
    progress: Progress = True,
) -> xr.Dataset:
    """Compute statistics as functions of keys of the scenario, like `mc sweep`.

    All points of the sweep share the same noise, unless `time.step` varies, so that differences
    between neighbouring points are much more precise than the estimates themselves. After Ctrl-C
    the points that are done are returned with a `StickSlipWarning`.

    Args:
        scenario: as for `run`.
        vary: the values of each key, as a sequence of numbers or as a string "START:STOP:COUNT" or
            "log:START:STOP:COUNT", e.g. `{"temperature.noise.intensity": np.linspace(0, 1, 21)}`;
            or the files of an input, e.g. `{"input.ag.file": ["a.at2", "b.at2"]}`.
            Each key is a dimension of the result, with the symbol of the key as its name. A key
            written "rho=temperature.noise.intensity" has the name rho. The values of several keys
            are combined in every possible way.
        zip: combine only the first values of all keys, then their second values, and so on.
        elasticity: a key or keys whose elasticities are computed, instead of `vary`: the relative
            change of each statistic for a relative change of the key.
        relative_step: for `elasticity`, the relative change of each key in both directions, from
            1e-6 to 0.5.
        independent: give every point a seed of its own. The errors of the points are then
            independent, and differences between points are less precise.
        paths, seed, scheme, step, tolerance, until, set, temperature, inputs, bias, own, threads,
            progress: as for `run`, at every point; `until` is a time, not a goal.

    Returns:
        With `vary`: `estimate`, `standard_error`, `interval_low`, `interval_high`, `bias` and
        `bias_uncertainty` with the dimensions of the sweep and `statistic`; `difference`,
        `difference_error`, `difference_low` and `difference_high` from each point to the next, with
        the further dimension `along`. With `elasticity`: the same estimates along `point` and
        `statistic`, and `elasticity`, `elasticity_error`, `elasticity_low` and `elasticity_high`
        along `key` and `statistic`. User-defined statistics are as in the result of `run`, at every
        point. `point_status` is 1 for finished points; the others are NaN.

    Raises:
        ScenarioError: the scenario, or a point of the sweep, is invalid.
        ArgumentError: another argument is invalid.
        KeyboardInterrupt: Ctrl-C came before the first point was done.
    """
    given = locals()
    ready()
    mappings('{"friction.static": [1.1, 1.2, 1.3]}', vary=vary)
    keys = [elasticity] if isinstance(elasticity, str) else list(elasticity)
    problem = "give either `vary` or `elasticity`"
    require(bool(vary) != bool(keys), "vary", vary, problem, "give one of them")
    parsed = parse(given)
    with shown(progress) as callback:
        made, estimates, is_interrupted = _native.sweep(
            parsed,
            vary=[f"{key}={_values(key, values)}" for key, values in (vary or {}).items()],
            zip=zip,
            elasticity=keys,
            relative_step=relative_step,
            independent=independent,
            bias=bias,
            own=_own.shown(own),
            threads=threads,
            progress=callback,
        )
    warn(["interrupted: missing points are NaN"] if is_interrupted else [])
    ds = dataset(made)
    axes = {axis: size for axis, size in ds.estimate.sizes.items() if axis != "statistic"}
    return ds.merge(_own.estimates(own, estimates, axes)) if own else ds


@public
def trade(
    scenario: ScenarioLike,
    *,
    budget: Time = 30.0,
    seed: int | None = None,
    set: Settings | None = None,
    temperature: Any = None,
    inputs: Mapping[str, Any] | None = None,
    threads: int | None = None,
    progress: Progress = True,
) -> xr.Dataset:
    """Measure what accuracy costs on this machine, like `mc trade`.

    Every scheme is run with several steps or tolerances. The runs give its bias, its
    variance, and the cheapest run for a given accuracy. After Ctrl-C the results so far are
    returned with a `StickSlipWarning`.

    Args:
        scenario, seed, set, temperature, inputs, threads, progress: as for `run`.
        budget: how long to measure, from 1 s to 7 d: seconds, a string such as "10m", or a timedelta.

    Returns:
        Along `rung`, one for each step or tolerance of each scheme: `rung_scheme`, `rung_step`,
        `rung_tolerance` and the CPU time `rung_seconds` of a path in seconds; along `rung` and
        `statistic`: `rung_bias` with its standard error `rung_bias_error`, and the variance per
        path `rung_path_variance`. Along `scheme` and `statistic`: the observed order of convergence
        `scheme_order`. Along `scheme`, `statistic` and `target`, a relative root mean square error:
        the cheapest run that is predicted to meet the target, as `predicted_seconds`,
        `predicted_paths`, `predicted_step` and `predicted_tolerance`; `winner` is the cheapest
        scheme.

    Raises:
        ScenarioError: the scenario is invalid.
        ArgumentError: `budget` is out of range.
        RunError: the budget is too small, or there is nothing to compare.
    """
    given = locals()
    ready()
    parsed = parse(given)
    with shown(progress) as callback:
        made, is_interrupted = _native.trade(parsed, seconds("budget", budget), threads, callback)
    warn(["interrupted: the results are partial"] if is_interrupted else [])
    return dataset(made)


def _values(key: str, values: Values) -> str:
    remedy = f'give several, e.g. {{"{key}": [1.1, 1.2]}}, or "START:STOP:COUNT"'
    require(hasattr(values, "__iter__"), "vary", f"{{{key!r}: {values!r}}}", "one value", remedy)
    return (
        values
        if isinstance(values, str)
        else ",".join(
            os.fspath(value)
            if isinstance(value, (str, os.PathLike))
            else _toml.value(key, float(value))
            for value in values
        )
    )
