"""Measured bearings: calibration, the weather, a forecast of years to come, and synthetic measurements."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta
from typing import TYPE_CHECKING, Any, Union

from . import _native
from ._data import dataset, ready, warn
from ._scenario import ScenarioLike, Settings, samples, source, written
from .errors import wrong_argument

if TYPE_CHECKING:
    import xarray as xr

#: A length of time: seconds, or a timedelta.
Time = Union[float, timedelta]

_YEAR_AND_DAY = (365.25 * 86_400.0, 86_400.0)


def calibrate(
    scenario: ScenarioLike,
    data: Any,
    displacement: Any = None,
    *,
    method: str = "both",
    fit: Sequence[str] = (),
    bounds: Mapping[str, tuple[float, float]] | None = None,
    starts: int = 10,
    lag: Time | None = None,
    interval: float = 0.9,
    temperature: str | os.PathLike[str] | None = None,
    unit: str | None = None,
    set: Settings | None = None,
    threads: int | None = None,
) -> xr.Dataset:
    """Friction, stiffness and dilatation of a bearing from its measured temperature and displacement, like `mc calibrate`.

    Args:
        scenario: K_BP, where a search begins, and the columns of the data. It needs no `[time]`.
        data: a CSV file; a pandas DataFrame with the columns that such a file has; or measured temperatures along time in degrees, as
            a pandas Series, a one-dimensional DataArray or a pair (times, values), with times in seconds or dates.
        displacement: of a CSV file or a DataFrame, the column of displacements; else measured displacements along time, in m.
        method: "slips", the paper's least squares "err", or "both".
        fit: keys of the parameters to fit; the others are held at what the scenario says. All if not given.
        bounds: between which values the least squares look for a parameter.
        starts: how many starts the least squares have.
        lag: seconds by which steel is behind the thermometer; estimated if not given.
        interval: the probability with which an interval is to hold the truth, from 0.5 to 0.999.
        temperature: the CSV file of temperatures, if they are not in that of displacements.
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
    ready()
    _probability(interval)
    if not 1 <= starts <= 1000:
        raise wrong_argument("starts", starts, "so many starts are none, or too many", "give 1 to 1000")
    made, remarks = _native.calibrate(
        _given(scenario, set),
        _record(data, displacement, temperature, unit),
        method=method,
        fit=list(fit),
        bounds=[(key, float(low), float(high)) for key, (low, high) in (bounds or {}).items()],
        starts=starts,
        lag=None if lag is None else _seconds("lag", lag),
        interval=interval,
        workers=threads,
    )
    warn(remarks)
    return dataset(made)


def forecast(
    scenario: ScenarioLike,
    data: Any,
    displacement: Any = None,
    *,
    draws: int = 50,
    years: int = 40,
    seed: int = 1,
    interval: float = 0.9,
    share: float = 0.9,
    processes: int = 2,
    temperature: str | os.PathLike[str] | None = None,
    unit: str | None = None,
    set: Settings | None = None,
    threads: int | None = None,
) -> xr.Dataset:
    """What years to come do to a bearing, like `mc forecast`: calibrated by its slips, under the weather of the same record.

    Args:
        scenario, data, displacement, temperature, unit, set, threads: as for `calibrate`.
        draws: how many draws of the parameters of bearing and weather, from the law of their errors.
        years: how many years for each draw.
        seed: decides all random numbers.
        interval: the probability with which an interval is to hold what it is about, from 0.5 to 0.999.
        share: the share of f_s above which time is counted as loaded, from 0 to below 1.
        processes: how many Ornstein-Uhlenbeck processes the weather has: 1, or a fast and a slow one.

    Returns:
        Along `quantity`: `expected`, the mean of a year with the likeliest parameters, `expected_low` and `expected_high` for what is not
        known of the parameters, `year_low` and `year_high` for one year; along `return_period` in years the |z| that is exceeded once in
        it, in m; and every year that was simulated, each quantity along `draw` and `year`: `sliding_path` in m, `slips`,
        `displacement_range` and `displacement_abs_max` in m, `loaded_share`, and `force_abs_max` in N where K_BP is known.

    Raises:
        ScenarioError: something in the scenario is wrong.
        ArgumentError: an argument, or something in the data, is wrong.
        RunError: the record does not tell the parameters of bearing or weather.
        KeyboardInterrupt: Ctrl-C came before two draws were done.
    """
    ready()
    _probability(interval)
    for name, count in (("draws", draws), ("years", years)):
        if not 2 <= count <= 10_000:
            raise wrong_argument(name, count, "so many are too few to say how sure it is, or too many", "give 2 to 10000")
    if not 0 <= share < 1:
        raise wrong_argument("share", share, "it is no share of f_s that friction can hold", "give 0 to below 1")
    _one_or_two(processes)
    made, remarks = _native.forecast(
        _given(scenario, set),
        _record(data, displacement, temperature, unit),
        draws=draws,
        years=years,
        seed=seed,
        interval=interval,
        share=share,
        processes=processes,
        workers=threads,
    )
    warn(remarks)
    return dataset(made)


@dataclass(frozen=True)
class Weather:
    """What `mc fit-temperature` prints: a measured temperature as a mean, harmonics and noise.

    Attributes:
        samples: how many samples were fitted.
        duration: the time from the first of them to the last, in s.
        mean: the mean temperature and its standard error, in degrees.
        harmonics: for each of them `period` in s, `amplitude` in K, `phase` in radians, where a cos(2 pi t/period + phase) counts t from
            the first sample, and `standard_error` of the amplitude.
        processes: for each Ornstein-Uhlenbeck process, the fastest first, `sd` in K and `relaxation_rate` in 1/s, with
            `sd_relative_error` and `relaxation_rate_relative_error`.
        sensor_sd: what the thermometer adds to every sample, in K; 0 where the data do not ask for it.
        log_likelihood: logarithm of the restricted likelihood.
        start: the stamp of the first sample, of a file with stamps.
        toml: the part of a scenario, to be added to the text of one without a temperature.
        temperature: the same as the table `temperature` of a dictionary.
    """

    samples: int
    duration: float
    mean: list[float]
    harmonics: list[dict[str, float]]
    processes: list[dict[str, float]]
    sensor_sd: float
    log_likelihood: float
    start: str | None
    toml: str
    temperature: dict[str, Any]


def fit_temperature(
    data: Any,
    *,
    processes: int = 2,
    periods: Sequence[Time] = _YEAR_AND_DAY,
    time: str = "time",
    temperature: str | None = None,
    zone: str | None = None,
) -> Weather:
    """Harmonics and noise of a scenario from a measured temperature, like `mc fit-temperature`.

    Args:
        data: a CSV file, a pandas DataFrame, or temperatures along time in degrees, as for `calibrate`.
        processes: how many Ornstein-Uhlenbeck processes the weather has: 1, or a fast and a slow one.
        periods: the periods of the harmonics, in seconds or as timedelta; none for no harmonics.
        time: the column of times, of a file or a DataFrame.
        temperature: the column of temperatures; the one whose name begins with `temperature` if not given.
        zone: the zone of stamps that name none, e.g. "UTC" or "Europe/Paris".

    Returns:
        The fit of largest likelihood, exact for samples at any times.

    Raises:
        ArgumentError: an argument, or something in the data, is wrong.
        RunError: the samples do not tell.
    """
    _one_or_two(processes)
    lengths = [_seconds("periods", period) for period in periods]
    if len({*lengths}) < len(lengths):
        raise wrong_argument("periods", list(periods), "they name one period twice", "name each period once")
    if _is_table(data):
        measured = _table(data, None, None, None)
    else:
        times, values, _ = samples(data, "data")
        measured = _arrays([times, values])
    fit = _native.fit_temperature(
        measured, processes=processes, periods=lengths, time=time, temperature=temperature, zone=zone
    )
    warn(fit.remarks)
    return Weather(
        fit.samples,
        fit.duration,
        list(fit.mean),
        [dict(zip(("period", "amplitude", "phase", "standard_error"), one)) for one in fit.harmonics],
        [dict(zip(("sd", "sd_relative_error", "relaxation_rate", "relaxation_rate_relative_error"), one)) for one in fit.processes],
        fit.sensor_sd,
        fit.log_likelihood,
        fit.start,
        fit.toml,
        _tables(fit.temperature),
    )


def _tables(temperature: tuple[list[tuple[float, float, float]], list[tuple[float, float, float]]]) -> dict[str, Any]:
    harmonics, noises = temperature
    return {
        "harmonics": [dict(zip(("amplitude", "angular_frequency", "phase"), one)) for one in harmonics],
        "noise": [dict(zip(("intensity", "relaxation_rate", "diffusion"), one), initial="stationary") for one in noises],
    }


def twin(
    scenario: ScenarioLike,
    *,
    seed: int = 1,
    sensor_noise: Sequence[Time] = (30e-6, 150e-6, 86_400.0),
    scatter: float = 0.0,
    lag: Time = 0.0,
    resolution: float = 0.0,
    spikes: float = 0.0,
    gaps: int = 0,
    duration: Time = 300 * 86_400.0,
    every: Time = 600.0,
    set: Settings | None = None,
    temperature: Any = None,
) -> xr.Dataset:
    """Synthetic measurements of a bearing whose truth is known, to try a calibration on, like `mc twin`.

    Args:
        scenario: the truth. Its temperature is the measured one of `[temperature.series]`, if it has that, and otherwise drawn from its
            harmonics and noise.
        seed: decides all random numbers; each flaw has random numbers of its own.
        sensor_noise: standard deviations of the white and of the red noise of the sensor, in m, and how long the red one remembers.
        scatter: by what share f_s differs from slip to slip (standard deviation), while f_d stays.
        lag: how far steel is behind the thermometer, in s.
        resolution: the thermometer shows multiples of this, in K.
        spikes: the share of displacements that are far off.
        gaps: how many stretches of one to five days are missing.
        duration: how long, in s, where the temperature is not a measured one.
        every: time between samples, in s, where the temperature is not a measured one.
        set: as for `run`.
        temperature: a measured temperature in the place of `[temperature.series]`, along time in seconds or dates, as for `run`.

    Returns:
        `temperature` in degrees and `displacement` in m along `time` in s, and `truth` along `quantity`: what a calibration is to find.
        `calibrate(scenario, ds.temperature, ds.displacement)` looks for it. Values are not rounded, as those of a file are.

    Raises:
        ScenarioError: something in the scenario is wrong.
        ArgumentError: an argument is wrong.
    """
    ready()
    for name, given, most in (("scatter", scatter, 0.5), ("spikes", spikes, 0.5), ("resolution", resolution, float("inf"))):
        if not 0 <= given < most:
            raise wrong_argument(name, given, "it is out of range", f"give a number from 0 to below {most:g}")
    if not 1 <= len(sensor_noise) <= 3:
        raise wrong_argument("sensor_noise", sensor_noise, "it is one to three numbers", "give (white, red, time), e.g. (30e-6, 150e-6, 86400)")
    sds: list[float] = []
    for sd in (*sensor_noise[:2], 0.0)[:2]:
        if isinstance(sd, timedelta) or not 0 <= sd < float("inf"):
            raise wrong_argument("sensor_noise", sd, "it is no standard deviation", "give metres, 0 or above")
        sds.append(float(sd))
    memory = _seconds("sensor_noise", sensor_noise[2]) if len(sensor_noise) == 3 else 86_400.0
    if gaps < 0:
        raise wrong_argument("gaps", gaps, "it is no number of gaps", "give 0 or more")
    seconds, step = _seconds("duration", duration), _seconds("every", every)
    if not 2 <= seconds / step <= 1e7:
        raise wrong_argument("duration", duration, f"{seconds / step:.0f} samples are not between 2 and 1e7", "choose other duration and every")
    first = None
    arrays = None
    if temperature is not None:
        times, values, first = samples(temperature)
        if len(times) < 2:
            raise wrong_argument("temperature", f"{len(times)} samples", "they are too few", "give two at least")
        arrays = [times, values]
    made, remarks = _native.twin(
        _given(scenario, set),
        arrays,
        seed=seed,
        noise=(sds[0], sds[1], memory),
        scatter=scatter,
        lag=0.0 if lag == 0 else _seconds("lag", lag),
        resolution=resolution,
        spikes=spikes,
        gaps=gaps,
        duration=seconds,
        every=step,
    )
    warn(remarks)
    ds = dataset(made)
    if first is not None:
        ds.attrs["start"] = f"{first.astype('datetime64[s]')}Z"
    return ds


def _given(scenario: ScenarioLike, settings: Settings | None) -> tuple[str, str | None, list[tuple[str, str]]]:
    return (*source(scenario), written(settings))


def _is_table(data: Any) -> bool:
    return isinstance(data, (str, os.PathLike)) or hasattr(data, "to_csv") and hasattr(data, "columns")


def _record(data: Any, displacement: Any, temperature: str | os.PathLike[str] | None, unit: str | None) -> _native.Measured:
    """The record of a bearing, however it is given."""
    if _is_table(data):
        if displacement is not None and not isinstance(displacement, str):
            raise wrong_argument("displacement", type(displacement).__name__, "the data have columns", "give the name of one")
        return _table(data, temperature, displacement, unit)
    if displacement is None:
        raise wrong_argument("displacement", None, "the temperatures come without displacements", "give both")
    if temperature is not None or unit is not None:
        raise wrong_argument(
            "temperature or unit", temperature or unit, "they are about files, and these data are arrays",
            "leave it out; arrays are in degrees and metres",
        )
    (times, temperatures, first), (when, readings, later) = samples(data, "data"), samples(displacement, "displacement")
    if (first is None) != (later is None):
        raise wrong_argument("displacement", "its times", "dates do not go with numbers", "give dates for both, or seconds for both")
    if first is not None and later is not None:
        import numpy as np

        when = when + (later - first) / np.timedelta64(1, "s")
    return _arrays([times, temperatures, when, readings])


def _table(data: Any, temperature: str | os.PathLike[str] | None, displacement: str | None, unit: str | None) -> _native.Measured:
    """A file, or a DataFrame as the text of one, so that the one reader reads it and its messages speak of it."""
    text = None
    name = "the DataFrame"
    if isinstance(data, (str, os.PathLike)):
        name = os.fspath(data)
    else:
        is_named = data.index.name is not None or not hasattr(data.index, "step")
        text = data.to_csv(index=is_named, index_label=data.index.name or "time")
    return {
        "name": name,
        "text": text,
        "temperature": None if temperature is None else os.fspath(temperature),
        "arrays": None,
        "displacement": displacement,
        "unit": unit,
    }


def _arrays(arrays: list[Any]) -> _native.Measured:
    return {"name": "the arrays", "text": None, "temperature": None, "arrays": arrays, "displacement": None, "unit": None}


def _seconds(argument: str, time: Time) -> float:
    seconds = time.total_seconds() if isinstance(time, timedelta) else float(time)
    if not 0 < seconds < 1e12:
        raise wrong_argument(argument, time, "it is no time above zero", "give seconds, or a timedelta")
    return seconds


def _probability(interval: float) -> None:
    if not 0.5 <= interval <= 0.999:
        raise wrong_argument("interval", interval, "it is no probability of an interval", "give 0.5 to 0.999")


def _one_or_two(processes: int) -> None:
    if processes not in (1, 2):
        raise wrong_argument("processes", processes, "the weather has one process or two", "give 1 or 2")
