"""Make a checked scenario of what a caller gives."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any, Literal, Union

from . import _native, _toml
from ._data import warn
from ._public import KEYS
from .errors import mappings, require, wrong_argument

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt

#: The path of a file, TOML text, the name of a shipped scenario, or a dictionary.
ScenarioLike = Union[str, "os.PathLike[str]", Mapping[str, Any]]

#: The name of a scheme: "discrete-vi", "corrected-vi", "event-driven" or "quasi-static".
Scheme = Literal["discrete-vi", "corrected-vi", "event-driven", "quasi-static"]

#: Keys of a scenario with their values: dotted keys such as "friction.static", or tables as
#: dictionaries.
Settings = Mapping[str, Any]

#: Labels of the unit of time that mean seconds.
_SECONDS = ("", "s", "sec", "second", "seconds")


def scenarios() -> dict[str, str]:
    """The shipped scenarios.

    Returns:
        The title of each by its name, which every function accepts as a scenario.
        `check(name).toml` is its text, with every default written out.
    """
    return {name: _native.parse(name, _native.shipped(name), []).title for name in _native.SHIPPED}


def parse(given: Mapping[str, Any], **replaced: object) -> _native.Scenario:
    """Read the scenario among the arguments of a function, some of which may be replaced, and apply
    overrides: first `set`, then the arguments that replace a key."""
    arguments: dict[str, Any] = {**given, **replaced}
    name, text = source(arguments["scenario"])
    # Messages quote the first of the three with the value behind it.
    laid = overrides(arguments.get("set"))
    for argument, key in KEYS.items():
        value = arguments.get(argument)
        if value is not None:
            # A text has no quotation marks.
            bare = value if isinstance(value, str) else _toml.value(key, value)
            laid.append((f"{argument} =", key, bare))
    measured, drawn, dated = [], [], None
    for argument, table, quantity, given in _measurements(arguments):
        own = realisations(given, argument)
        if own is not None:
            drawn.append((table, *own))
            continue
        times, values, first = samples(given, argument)
        times, values, remarks = _native.repaired(argument, quantity, times, values, None)
        warn(remarks, level=5)
        measured.append((table, times, values))
        dated = dated if first is None else argument
    parsed = _native.parse(name, text, laid, measured, False, drawn)
    for table, _, values in drawn:
        count = None if callable(values) else len(values)
        require(
            count is None or parsed.paths <= count,
            table,
            f"{count} realisations",
            f"the run has {parsed.paths} paths, each of which needs its own",
            f"give more realisations, or run {count} paths with `paths={count}`",
        )
    require(
        dated is None or parsed.time_unit in _SECONDS,
        dated or "temperature",
        "a series with dates",
        f'its times are in seconds, but `units.time` is "{parsed.time_unit}"',
        'write the whole scenario in seconds, and `time = "s"` under [units]',
    )
    return parsed


def _measurements(arguments: Mapping[str, Any]) -> Iterator[tuple[str, str, str, Any]]:
    """Each measurement among the arguments: its argument, its table, its quantity, and itself."""
    temperature, inputs = arguments.get("temperature"), arguments.get("inputs")
    mappings('{"ag": (times, accelerations)}', inputs=inputs)
    if temperature is not None:
        yield "temperature", "temperature.series", "temperature", temperature
    for name, given in (inputs or {}).items():
        yield f"inputs.{name}", f"input.{name}", "input", given


def realisations(given: Any, argument: str) -> tuple[npt.NDArray[np.float64], Any] | None:
    """Times, and values with a row for each path or a function that draws them; None if `given` is
    one measurement.

    `given` is a pair (times, values) with values of shape (paths, time), a pair (times, draw) with a
    function draw(rng, times), or an xarray DataArray with the dimensions path and time.
    """
    import numpy as np

    if hasattr(given, "dims") and "path" in getattr(given, "dims", ()):
        others = [name for name in given.dims if name != "path"]
        require(
            len(others) == 1,
            argument,
            f"dimensions {tuple(given.dims)}",
            "it has more dimensions than path and time",
            "select one element of the others",
        )
        times, values = given[others[0]].to_numpy(), given.transpose("path", others[0]).to_numpy()
    elif isinstance(given, tuple) and len(given) == 2:
        times, values = given
        if not callable(values) and np.ndim(values) != 2:
            return None
    else:
        return None
    times = np.ascontiguousarray(times, dtype=np.float64)
    if callable(values):
        return times - times[:1], values
    values = np.ascontiguousarray(values, dtype=np.float64)
    require(
        times.ndim == 1 and values.shape[1:] == times.shape,
        argument,
        f"shapes {times.shape} and {values.shape}",
        "there must be one value for each path and time",
        "give values of shape (paths, time)",
    )
    return times - times[:1], values


def overrides(settings: Settings | None) -> list[tuple[str, str, str]]:
    """What messages call each setting, its dotted key, and its value as TOML."""
    return [(f"set {key} =", key, value) for key, value in written(settings)]


def written(settings: Settings | None) -> list[tuple[str, str]]:
    """The dotted keys with their values as TOML."""
    mappings('{"friction.static": 1.3}', set=settings)
    return [(key, _toml.value(key, given)) for key, given in _flat("", settings or {})]


def _flat(table: str, settings: Settings) -> Iterator[tuple[str, Any]]:
    """The dotted keys with their values. A dictionary stands for the keys in it, so that it leaves
    the others of its table as they are."""
    for key, given in settings.items():
        if isinstance(given, Mapping) and given:
            yield from _flat(f"{table}{key}.", given)
        else:
            yield f"{table}{key}", given


def source(scenario: ScenarioLike) -> tuple[str, str | None]:
    """The name of a scenario in messages, and its text; no text if it is in a file."""
    if isinstance(scenario, Mapping):
        return "scenario", _toml.document(scenario)
    require(
        isinstance(scenario, (str, os.PathLike)),
        "scenario",
        type(scenario).__name__,
        "it is not a scenario",
        "give the path of a TOML file, TOML text, the name of a shipped scenario, or a dictionary",
    )
    path = os.fspath(scenario)
    if "\n" in path:
        return "scenario", path
    shipped = None if os.path.isfile(path) else _native.shipped(path)
    return path, shipped


def samples(
    given: Any, argument: str = "temperature"
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], np.datetime64 | None]:
    """Times and values of a measurement, and the first date if the times are dates.

    `given` is a pandas Series, whose index is the time, a one-dimensional xarray DataArray, or a
    pair of arrays. Dates become seconds since the first of them. Masked values are missing, as NaN
    is. `argument` is the name of the argument in messages.

    Raises:
        ArgumentError: there are no times and values, their shapes differ, or a time is masked.
    """
    import numpy as np

    if hasattr(given, "index") and hasattr(given, "to_numpy"):
        times, values = given.index.to_numpy(), given.to_numpy()
    elif hasattr(given, "dims") and hasattr(given, "to_numpy") and len(given.dims) == 1:
        times, values = given[given.dims[0]].to_numpy(), given.to_numpy()
    else:
        try:
            times, values = given
        except (TypeError, ValueError):
            raise wrong_argument(
                argument,
                type(given).__name__,
                "it has no times and values",
                "give a pandas Series, a one-dimensional DataArray, or a pair (times, values)",
            ) from None
    require(
        not np.ma.is_masked(times),
        argument,
        "a masked time",
        "every value needs a time",
        "remove the samples without a time, e.g. x[~numpy.ma.getmaskarray(times)]",
    )
    require(
        not (np.iscomplexobj(times) or np.iscomplexobj(values)),
        argument,
        "complex numbers",
        "measurements must be real",
        "give the real part, e.g. x.real",
    )
    times = np.asarray(times)
    values = np.ma.filled(np.ma.asarray(values, dtype=np.float64), np.nan)
    first = None
    if times.dtype.kind == "O" and len(times) and hasattr(times[0], "timestamp"):
        # Dates with a time zone.
        times = np.array([np.datetime64(round(1e6 * date.timestamp()), "us") for date in times])
    if times.dtype.kind == "M" and len(times):
        first = np.datetime64(times[0])
        times = (times - times[0]) / np.timedelta64(1, "s")
    times = np.ascontiguousarray(times, dtype=np.float64)
    require(
        times.ndim == 1 and times.shape == values.shape,
        argument,
        f"shapes {times.shape} and {values.shape}",
        "times and values have different shapes",
        "give one-dimensional times and values of equal length",
    )
    return times, np.ascontiguousarray(values), first
