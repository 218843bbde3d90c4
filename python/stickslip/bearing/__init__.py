"""Measured bearings: calibration, weather, forecast of future years, and synthetic measurements."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import timedelta
from typing import TYPE_CHECKING, Any, Literal

from .. import _native
from .._data import dataset, ready, warn
from .._progress import Progress, shown
from .._public import public
from .._scenario import ScenarioLike, Settings, samples, source, written
from .._time import Time
from .._time import seconds as _seconds
from ..errors import require, within

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    import xarray as xr


@dataclass(frozen=True)
class Layout:
    """The layout of a file or a DataFrame with measurements, where its header does not define it.

    Attributes:
        temperature: the name of the temperature column; by default, the one whose name begins with
            `temperature`.
        temperature_file: the path of the CSV file of temperatures, if the file of displacements
            lacks them.
        temperature_unit: the unit of temperatures: "degC", "K", "degF" or "degR".
        displacement_unit: the unit of displacements: "m", "cm", "mm" or "um".
        time: the name of the time column, or the names of the columns of dates and of times of day,
            separated by a comma; by default, a column with a usual name, such as "time",
            "Timestamp" or "Date/Time".
        zone: the time zone of dates without one, e.g. "UTC" or "Europe/Paris".
        dates: the order of year, month and day: "ymd", "dmy" or "mdy"; by default, the year first,
            or else the order for which all dates are valid and ascending.
        skip: number of lines before the column names; by default, all lines before the first one
            that contains the required names.
        missing: numbers and words that mark a missing value, besides the usual ones.
        skip_bad: leave out lines that cannot be read, such as a footer, and report how many.
        outliers: leave out values that differ from their neighbours by more than this many standard
            deviations of such differences, e.g. 8; by default, no value is left out. It also
            applies to arrays.
        decimal: the decimal mark of numbers, "." or ","; by default, inferred from all numbers.
        averaged: averaging time of each value, which ends at its time stamp; 0 for instantaneous
            values; by default, taken from the column name. It also applies to arrays.
        of_temperatures: the layout of the temperatures, if it differs.
    """

    temperature: str | None = None
    temperature_file: str | os.PathLike[str] | None = None
    temperature_unit: str | None = None
    displacement_unit: str | None = None
    time: str | None = None
    zone: str | None = None
    dates: str | None = None
    skip: int | None = None
    missing: Sequence[str | float] = ()
    skip_bad: bool = False
    outliers: int | None = None
    decimal: str | None = None
    averaged: Time | None = None
    of_temperatures: Layout | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "missing", tuple(map(str, self.missing)))
        if self.averaged:
            object.__setattr__(self, "averaged", _seconds("averaged", self.averaged))


@public
def calibrate(
    scenario: ScenarioLike,
    data: Any,
    displacement: Any = None,
    *,
    method: Literal["slips", "criterion", "both"] = "slips",
    fit: Sequence[str] = (),
    bounds: Mapping[str, tuple[float, float]] | None = None,
    starts: int = 10,
    lag: Time | None = None,
    interval: float = 0.9,
    layout: Layout | None = None,
    set: Settings | None = None,
    threads: int | None = None,
    progress: Progress = True,
) -> xr.Dataset:
    """Estimate friction, stiffness and dilatation of a bearing from its measured temperature and
    displacement, like `mc calibrate`.

    Args:
        scenario: as for `run`, in SI units. It gives the stiffness K_BP of the bearing, the initial
            values of a search, and the column names of the data. A table `[time]` is not needed.
        data: the measurement: the path of a CSV file; a pandas DataFrame with the same columns; or
            the measured temperatures alone, in degrees Celsius over time, as a pandas Series, a
            one-dimensional DataArray or a pair (times, values) of one-dimensional arrays. Times are
            in seconds, or dates.
        displacement: the measured displacements. For a file or a DataFrame, the name of their
            column; by default, the one whose name begins with `displacement`. Otherwise, the
            displacements in metres over time, in any of the forms of the temperatures, with the
            same or different times.
        method: "slips" to estimate from the slips, "criterion" for the least-squares criterion of
            the paper, or "both".
        fit: the keys of the parameters to fit; by default, all. The other parameters keep the values
            of the scenario.
        bounds: for least squares, the lowest and the highest value of a parameter by its key, e.g.
            `{"friction.static": (4e5, 6e5)}`. By default, a box around the estimates from the
            slips.
        starts: number of starting points of the least squares, from 1 to 1000.
        lag: delay of the temperature of the steel behind the thermometer, in seconds, as a string
            such as "10m", or as a timedelta; estimated if not given.
        interval: confidence level of the intervals, from 0.5 to 0.999.
        layout: the layout of a file or a DataFrame, where its header does not define it.
        set: further keys of the scenario with their values, as for `run`.
        threads: number of threads; one for each core if not given.
        progress: as for `run`; no paths are counted.

    Returns:
        Along `quantity`, the name of a parameter: `estimate` with its interval from `interval_low`
        to `interval_high`, in the unit `quantity_unit`, and the same by the least squares as
        `least_squares`, `least_squares_low` and `least_squares_high`. Along `slip`: time,
        temperature and size of each detected slip. Along `start`: the result of each starting
        point. Along `time`, in seconds from the first sample: the measurement, and
        `displacement_modelled` in metres.

    Raises:
        ScenarioError: the scenario is invalid.
        ArgumentError: an argument, or the data, are invalid.
        RunError: the measurement does not determine the parameters.
    """
    ready()
    within(0.5, 0.999, interval=interval)
    within(1, 1000, starts=starts)
    with shown(progress) as callback:
        made, remarks = _native.calibrate(
            (*source(scenario), written(set)),
            _record(data, displacement, layout or Layout()),
            method=method,
            fit=list(fit),
            bounds=[(key, float(low), float(high)) for key, (low, high) in (bounds or {}).items()],
            starts=starts,
            lag=None if lag is None else _seconds("lag", lag),
            interval=interval,
            threads=threads,
            progress=callback,
        )
    warn(remarks)
    return dataset(made)


@public
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
    layout: Layout | None = None,
    set: Settings | None = None,
    threads: int | None = None,
    progress: Progress = True,
) -> xr.Dataset:
    """Simulate future years of a bearing, like `mc forecast`.

    The bearing is calibrated from the slips in its measurement, and the weather is fitted to the
    temperatures of the same measurement. Years are simulated for the estimated parameters, and for
    parameters drawn from the distribution of their errors.

    Args:
        scenario, data, displacement, layout, set, threads, progress: as for `calibrate`.
        draws: number of draws of the parameters of bearing and weather, from 2 to 10000.
        years: number of years for each draw, from 2 to 10000.
        seed: seed of all random numbers.
        interval: confidence level of the intervals, from 0.5 to 0.999.
        share: a fraction of f_s, from 0 to below 1. Time counts as loaded while the friction force
            is above this fraction of f_s.
        processes: number of Ornstein-Uhlenbeck processes in the weather: 1, or 2 for a fast and a
            slow one.

    Returns:
        Along `quantity`, in the unit `quantity_unit`: `expected`, the mean of a year with the most
        likely parameters, its interval `expected_low` to `expected_high`, which includes the
        uncertainty of the parameters, and the interval `year_low` to `year_high` for a single year.
        Along `return_period`, in years: `return_level`, the |z| in metres exceeded once per period,
        with its interval `return_level_low` to `return_level_high`. Along `draw` and `year`, each
        simulated year: `sliding_path` in m, `slips`, `displacement_range` and
        `displacement_abs_max` in m, `loaded_share`, and `force_abs_max` in N if K_BP is known.

    Raises:
        ScenarioError: the scenario is invalid.
        ArgumentError: an argument, or the data, are invalid.
        RunError: the measurement does not determine the parameters of bearing or weather.
        KeyboardInterrupt: within a second after Ctrl-C; nothing is returned.
    """
    ready()
    within(0.5, 0.999, interval=interval)
    within(2, 10_000, draws=draws, years=years)
    require(0 <= share < 1, "share", share, "out of range", "must be in [0, 1)")
    within(1, 2, processes=processes)
    with shown(progress) as callback:
        made, remarks = _native.forecast(
            (*source(scenario), written(set)),
            _record(data, displacement, layout or Layout()),
            draws=draws,
            years=years,
            seed=seed,
            interval=interval,
            share=share,
            processes=processes,
            threads=threads,
            progress=callback,
        )
    warn(remarks)
    return dataset(made)


@dataclass(frozen=True, repr=False)
class Weather:
    """A measured temperature as a mean, harmonics and noise, as `mc fit-temperature` prints it.

    Attributes:
        samples: number of samples that were fitted.
        duration: time from the first to the last sample, in s.
        mean: the mean temperature and its standard error, in degrees Celsius.
        harmonics: for each harmonic its `period` in s, `amplitude` in K, `phase` in radians, and
            the `standard_error` of the amplitude in K. With t from the first sample on, a harmonic
            is amplitude cos(2 pi t/period + phase).
        processes: for each Ornstein-Uhlenbeck process, the fastest first, its standard deviation
            `sd` in K and its `relaxation_rate` in 1/s, with the relative standard errors
            `sd_relative_error` and `relaxation_rate_relative_error`.
        sensor_sd: standard deviation of the white noise of the thermometer, in K; 0 if the data
            show none.
        smoothing: time constant of the low-pass filter that smooths the processes, in s; None if
            they are not smoothed.
        log_likelihood: logarithm of the restricted likelihood of the fit.
        start: the date of the first sample, if the times of a file or a DataFrame are dates.
        toml: the temperature as TOML text, to be appended to a scenario without a temperature.
        temperature: the same as the table `temperature` of a scenario that is a dictionary.
    """

    samples: int
    duration: float
    mean: list[float]
    harmonics: list[dict[str, float]]
    processes: list[dict[str, float]]
    sensor_sd: float
    smoothing: float | None
    log_likelihood: float
    start: str | None
    toml: str
    temperature: dict[str, Any]

    def __repr__(self) -> str:
        """The most important numbers, and the temperature as TOML text."""
        mean, error = self.mean
        lines = [f"# {self.samples} samples, mean ({mean:.4g} +- {error:.1g}) degC"]
        for wave in self.harmonics:
            size = f"amplitude ({wave['amplitude']:.4g} +- {wave['standard_error']:.1g}) K"
            lines.append(f"# period {wave['period']:g} s: {size}")
        for process in self.processes:
            memory = f"correlation time {1 / process['relaxation_rate']:.3g} s"
            lines.append(f"# noise: standard deviation {process['sd']:.3g} K, {memory}")
        return "\n".join(lines) + "\n" + self.toml


@public
def fit_temperature(
    data: Any,
    *,
    processes: int = 2,
    periods: Sequence[Time] | None = None,
    layout: Layout | None = None,
    progress: Progress = True,
) -> Weather:
    """Fit harmonics and noise of a scenario to a measured temperature, like `mc fit-temperature`.

    The fit maximises the restricted likelihood, which is exact for samples at any times.

    Args:
        data: the path of a CSV file, a pandas DataFrame, or temperatures over time in degrees
            Celsius, as for `calibrate`.
        processes: largest number of Ornstein-Uhlenbeck processes in the noise: 1, or 2 for a fast
            and a slow one.
        periods: the periods of the harmonics, in seconds, as a string such as "10m", or as a
            timedelta; by default, a year of 365.25 days and a day, if the samples resolve them.
            With an empty sequence, no harmonics are fitted.
        layout, progress: as for `calibrate`.

    Returns:
        The fitted temperature with its standard errors.

    Raises:
        ArgumentError: an argument, or the data, are invalid.
        RunError: the samples do not determine the fit.
    """
    within(1, 2, processes=processes)
    lengths = None
    if periods is not None:
        lengths = [_seconds("periods", period) for period in periods]
        problem = "a period is listed twice"
        is_right = len({*lengths}) == len(lengths)
        require(is_right, "periods", list(periods), problem, "list each period once")
    layout = layout or Layout()
    if _is_table(data):
        measured = _table(data, layout)
    else:
        times, values, *_ = _repaired(data, "data", "temperature", layout.outliers)
        measured = _Measured("the arrays", layout, arrays=[times, values])
    with shown(progress) as callback:
        fit, remarks = _native.fit_temperature(
            measured, processes=processes, periods=lengths, progress=callback
        )
    warn(remarks)
    return Weather(**fit)


@public
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
    drift: float = 0.0,
    zero_set: tuple[Time, float] | None = None,
    thermometer_every: int = 1,
    start: str | None = None,
    duration: Time = 300 * 86_400.0,
    every: Time = 600.0,
    set: Settings | None = None,
    temperature: Any = None,
    progress: Progress = True,
) -> xr.Dataset:
    """Make synthetic measurements of a bearing with known parameters, like `mc twin`.

    Use them to test a calibration: `calibrate(scenario, ds.temperature, ds.displacement)`
    estimates the parameters from them, and `ds.truth` holds the true values.

    Args:
        scenario: the scenario with the true parameters, as for `calibrate`. Its temperature is the
            measured one of `[temperature.series]`, if it has that table, and otherwise is simulated
            from its harmonics and noise.
        seed: seed of all random numbers. Each of the errors below has its own random numbers.
        sensor_noise: the standard deviations of the white and of the red noise of the displacement
            sensor, in metres, and the correlation time of the red noise. A time is in seconds, a
            string such as "10m", or a timedelta.
        scatter: relative standard deviation of f_s from slip to slip, from 0 to below 0.5; f_d does
            not vary.
        lag: delay of the temperature of the steel behind the thermometer.
        resolution: resolution of the thermometer in kelvin: its readings are multiples of it.
        spikes: the fraction of displacements that are outliers, from 0 to below 0.5; they deviate by
            up to 20 standard deviations of the sensor noise.
        gaps: number of gaps in the measurement, of one to five days each.
        drift: drift of the displacement sensor, in metres per year.
        zero_set: the time at which the displacement sensor is set to zero, and the shift of its
            readings from then on, in metres; None if it is not set to zero.
        thermometer_every: the thermometer records only every n-th sample; the others are NaN.
        start: the date of the first sample (UTC if it has no zone), at which t = 0 in the
            harmonics, if the temperature is simulated; by default 2015-01-01T00:00:00Z.
        duration: length of the measurement, if the temperature is simulated.
        every: time between samples, if the temperature is simulated.
        set: further keys of the scenario with their values, as for `run`.
        temperature: a measured temperature, which replaces `[temperature.series]`, in degrees
            Celsius over time in seconds or dates, in the forms that `run` accepts.
        progress: as for `calibrate`.

    Returns:
        Along `time` in seconds: `temperature` in degrees Celsius and `displacement` in metres. They
        are not rounded, unlike those in a file of `mc twin`. Along `quantity`: `truth`, the true
        parameters in the unit `quantity_unit`. The attribute `start` is the date of time 0.

    Raises:
        ScenarioError: the scenario is invalid.
        ArgumentError: an argument is invalid.
    """
    ready()
    for name, given, most in (
        ("scatter", scatter, 0.5),
        ("spikes", spikes, 0.5),
        ("resolution", resolution, float("inf")),
    ):
        remedy = f"give a number of at least 0 and below {most:g}"
        require(0 <= given < most, name, given, "it is out of range", remedy)
    require(
        1 <= len(sensor_noise) <= 3,
        "sensor_noise",
        sensor_noise,
        "must be one to three numbers",
        "give (white, red, time), e.g. (30e-6, 150e-6, 86400)",
    )
    parts: list[Any] = [*sensor_noise, *(0.0, 86_400.0)[len(sensor_noise) - 1 :]]
    white, red, memory = parts
    for sd in (white, red):
        is_right = not isinstance(sd, (str, timedelta)) and 0 <= sd < float("inf")
        problem = "must be a standard deviation"
        require(is_right, "sensor_noise", sd, problem, "give metres, at least 0")
    within(0, 2**32 - 1, gaps=gaps)
    require(abs(drift) < float("inf"), "drift", drift, "must be finite", "give metres per year")
    within(1, 2**32, thermometer_every=thermometer_every)
    moved = None if zero_set is None else (_seconds("zero_set", zero_set[0]), float(zero_set[1]))
    seconds, step = _seconds("duration", duration), _seconds("every", every)
    problem = f"{seconds / step:.0f} samples; must be between 2 and 1e7"
    is_right = 2 <= seconds / step <= 1e7
    require(is_right, "duration", duration, problem, "change duration or every")
    first = None
    arrays = None
    if temperature is not None:
        times, values, first, _ = _repaired(temperature, "temperature", "temperature")
        arrays = [times, values]
    with shown(progress) as callback:
        made, remarks = _native.twin(
            (*source(scenario), written(set)),
            arrays,
            seed=seed,
            noise=(float(white), float(red), _seconds("sensor_noise", memory)),
            scatter=scatter,
            lag=0.0 if lag == 0 else _seconds("lag", lag),
            resolution=resolution,
            spikes=spikes,
            gaps=gaps,
            drift=float(drift),
            zero_set=moved,
            thermometer_every=thermometer_every,
            start=start,
            duration=seconds,
            every=step,
            progress=callback,
        )
    warn(remarks)
    ds = dataset(made)
    if first is not None:
        ds.attrs["start"] = f"{first.astype('datetime64[s]')}Z"
    return ds


@dataclass(frozen=True)
class _Measured:
    """A measurement in the form that the engine accepts: a file or a text with this name, or arrays
    of times and values."""

    name: str
    layout: Layout
    text: str | None = None
    arrays: list[Any] | None = None
    displacement: str | None = None
    repairs: Sequence[str] = ()


def _is_table(data: Any) -> bool:
    return (
        isinstance(data, (str, os.PathLike)) or hasattr(data, "to_csv") and hasattr(data, "columns")
    )


def _record(data: Any, displacement: Any, layout: Layout) -> _Measured:
    """The measurement of a bearing."""
    if _is_table(data):
        require(
            displacement is None or isinstance(displacement, str),
            "displacement",
            type(displacement).__name__,
            "the data are a table",
            "give the name of one",
        )
        return _table(data, layout, displacement)
    problem = "displacements are missing"
    require(displacement is not None, "displacement", None, problem, "give both")
    for name, given in vars(layout).items():
        require(
            name in ("outliers", "averaged", "of_temperatures") or not given,
            f"layout.{name}",
            given,
            "it applies to files, but the data are arrays",
            "remove it; arrays are in degrees Celsius, metres, and seconds or dates",
        )
    times, temperatures, first, of_air = _repaired(data, "data", "temperature", layout.outliers)
    when, readings, later, of_sensor = _repaired(
        displacement, "displacement", "displacement", layout.outliers
    )
    require(
        (first is None) == (later is None),
        "displacement",
        "its times",
        "dates cannot be combined with numbers",
        "give dates for both, or seconds for both",
    )
    if first is not None and later is not None:
        import numpy as np

        when = when + (later - first) / np.timedelta64(1, "s")
    arrays = [times, temperatures, when, readings]
    return _Measured("the arrays", layout, arrays=arrays, repairs=(*of_air, *of_sensor))


def _table(data: Any, layout: Layout, displacement: str | None = None) -> _Measured:
    """A file, or a DataFrame as the text of such a file, so that the same reader checks it and its
    messages fit."""
    if isinstance(data, (str, os.PathLike)):
        return _Measured(os.fspath(data), layout, displacement=displacement)
    is_named = data.index.name is not None or not hasattr(data.index, "step")
    text = data.to_csv(index=is_named, index_label=data.index.name or "time")
    return _Measured("the DataFrame", layout, text, displacement=displacement)


def _repaired(
    given: Any, argument: str, quantity: str, outliers: int | None = None
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], np.datetime64 | None, list[str]]:
    """The samples, checked and repaired as the reader of a file does it, and the repairs."""
    times, values, first = samples(given, argument)
    times, values, remarks = _native.repaired(argument, quantity, times, values, outliers)
    warn(remarks, level=6)
    return times, values, first, remarks
