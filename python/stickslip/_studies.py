"""Many runs, one question: sweeps and the trade."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

from . import _native, _toml
from ._data import dataset, ready, warn
from ._progress import Progress, shown
from ._scenario import ScenarioLike, Settings, parse
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
    parsed = parse(
        scenario, set, temperature, paths=paths, seed=seed, scheme=scheme, step=step, tolerance=tolerance, until=until
    )
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
    parsed = parse(scenario, set, temperature, seed=seed)
    made, is_interrupted = _native.trade(parsed, float(budget), threads)
    warn(["interrupted: what was measured until then is told"] if is_interrupted else [])
    return dataset(made)


def _values(key: str, values: Values) -> str:
    return values if isinstance(values, str) else ",".join(_toml.value(key, float(value)) for value in values)
