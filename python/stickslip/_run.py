"""Simulate an ensemble, join its parts, and simulate one of its paths again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

from . import _native, _own
from ._data import dataset, raw, ready, warn
from ._own import Statistic
from ._progress import Progress, Callback, shown
from ._public import public
from ._scenario import ScenarioLike, Scheme, Settings, parse
from ._time import Time
from ._time import seconds as _seconds
from .errors import mappings, require, within

if TYPE_CHECKING:
    import xarray as xr

#: The time at which each path ends, or goals such as "stick_duration_mean < 0.5%", which end the
#: run.
Until = Union[float, str, Sequence[str]]

#: What is recorded: names such as "paths" and "events", or a dictionary, which may also have the
#: key "trajectories".
Record = Union[str, Sequence[str], Mapping[str, Any]]

#: The formats of data sets that are not of a run.
STUDIES = ("stick-slip trade", "stick-slip sweep", "stick-slip calibration")

#: The attributes of the state of a part.
_PART_STATE = {"long_name": "state of a part of a run, used by mc merge"}


@public
def run(
    scenario: ScenarioLike,
    *,
    paths: int | None = None,
    seed: int | None = None,
    scheme: Scheme | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    until: Until | None = None,
    set: Settings | None = None,
    record: Record | None = None,
    temperature: Any = None,
    inputs: Mapping[str, Any] | None = None,
    accuracy: float | None = None,
    statistic: str | Sequence[str] = (),
    max_time: Time | None = None,
    part: str | None = None,
    bias: bool = True,
    own: Mapping[str, Statistic] | None = None,
    threads: int | None = None,
    progress: Progress = True,
) -> xr.Dataset:
    """Simulate an ensemble of paths and return its statistics, like `mc run`.

    The result is what `xarray.open_dataset` reads from the file that `mc run` writes: the same
    variables, dimensions, attributes and bits, for any number of threads. Ctrl-C ends the run
    within 0.3 s. The paths that are done by then are returned, with a `StickSlipWarning` and with
    the attribute `status` equal to "interrupted".

    In brackets below is the key of the scenario that an argument replaces. None keeps the value of
    the scenario.

    Args:
        scenario: the path of a TOML file, TOML text of several lines, the name of a shipped
            scenario such as "rho025", or a dictionary of tables with the structure of the TOML
            file.
        paths: number of paths [ensemble.paths]. With a goal (see `until`), the largest number of
            paths.
        seed: seed of all random numbers [ensemble.seed]. A path depends only on the scenario, the
            seed and its number.
        scheme: the simulation scheme: "discrete-vi", "corrected-vi", "event-driven" or
            "quasi-static" [scheme.kind].
        step: time step of "discrete-vi" and "corrected-vi", in the unit of time of the scenario
            [time.step].
        tolerance: permitted relative discretisation error of "event-driven" and "quasi-static"
            [scheme.tolerance].
        until: the time at which each path ends, in the unit of time of the scenario [time.end]; or
            a goal; or a list of goals with at most one end time. A goal is a string such as
            "stick_duration_mean < 0.5%", or "stick_duration_mean < 0.01" in the unit of the
            statistic. With goals, paths are added until the standard error of each named statistic
            is below its bound.
        set: further keys of the scenario with their values, e.g. `{"friction.static": 1.3}` or
            `{"friction": {"static": 1.3}}`. A dictionary as a value leaves the other keys of its
            table as they are.
        record: what is recorded: "paths" for a few numbers of each path, "events" for every event
            of each path, "laws" for distributions of slips, "density" for densities of x and x',
            "energy" for the work of every force, "spectrum" for spectra; a list of these names; or
            a dictionary such as `{"events": True, "trajectories": 3}`, in which `trajectories` is
            the number of paths whose trajectory is recorded.
        temperature: a measured temperature, which replaces the table `[temperature.series]` of the
            scenario: a pandas Series with time as its index, a one-dimensional DataArray along
            time, or a pair (times, values) of one-dimensional arrays of equal length. Times and
            values are in the units of the scenario. Times may also be dates; they become seconds
            since the first of them, and the unit of time of the scenario must be the second.
        inputs: measured inputs by name, e.g. `{"ag": (times, accelerations)}`, in place of the
            tables `[input.NAME]`. The first time is 0, and nothing is repaired. An input, and the
            temperature, may also have a realisation for each path: values of shape (paths, time), a
            DataArray with a dimension `path`, or a pair (times, draw) with a function
            draw(rng, times) that returns the values of a path.
        accuracy: a relative error from 1e-6 to 0.5, e.g. 0.01. Scheme, step or tolerance, and
            number of paths are chosen for this error, after a pilot run of about 8 s. It cannot be
            combined with `paths`, `scheme`, `step`, `tolerance` or a goal. The attribute `accuracy`
            of the result records the choice.
        statistic: the name or names of the statistics that `accuracy` applies to; by default, all
            of `STATISTICS`.
        max_time: limit on the wall-clock time: seconds, a string such as "10m", "1.5h" or "1d 2h",
            or a timedelta. The run ends within it, with the attribute `status` equal to "ended".
        part: one part of the run, e.g. "3/16" for the third of 16. `merge` joins the parts. It
            cannot be combined with a goal, `max_time`, `accuracy` or `own`.
        bias: whether to estimate the bias of each statistic due to the time step. The
            estimate takes up to an eighth of the time.
        own: user-defined statistics, as functions by name. A function is called with the `Events` of
            a block of at most 256 paths and returns one finite number for each path: an array of
            shape `(len(events.count),)`, whose mean over all paths is estimated. A function may
            also return a pair of such arrays; the ratio of their means is then estimated.
        threads: number of threads; one for each core if not given.
        progress: whether a line in the terminal or the notebook shows the progress of what takes
            longer than two seconds; nothing is shown elsewhere. Or a callable
            `f(done, expected, stage)`, which is called a few times a second with the number of
            paths that are done, the number expected in all, and what is being done. The numbers are
            0 in a stage that does not count paths. An exception in the callable ends the run.

    Returns:
        A data set with one value for each statistic along `statistic` (coordinate: the names in
        `STATISTICS`): `estimate`, `standard_error`, the 95 % confidence interval from
        `interval_low` to `interval_high`, and `bias` with `bias_uncertainty`. They are in the units
        of `statistic_unit`, and NaN where the statistic does not exist. The interval covers
        only the error of a finite ensemble; `estimate_corrected` and its interval also allow for
        the bias.

        Curves of mean, standard deviation and quantiles are along `time`, the histogram and the
        survival curve of stick durations along `law` and `law_bin`, and the numbers of sub-phases
        along `sub_phase`. The interval of such a variable has its name and `_interval`. Per-path
        records are along `path`, `event` and `trajectory`. User-defined statistics are
        `own_estimate`, `own_standard_error`, `own_interval_low` and `own_interval_high` along
        `own`. All intervals are 95 %, with paths as independent units.

        The attributes contain everything needed to repeat the run, such as the resolved `scenario`,
        `seed` and `paths`, and how it ended (`status`, `completed_paths`). The page
        `docs/output-format.md` lists every variable and attribute.

    Raises:
        ScenarioError: the scenario, or an argument that replaces one of its keys, is
            invalid. The error gives the location and a fix.
        ArgumentError: another argument is invalid, or two of them cannot be combined.
        RunError: `max_time` was reached before the first paths were done.
        KeyboardInterrupt: Ctrl-C came before the first paths were done.
        Exception: whatever a function in `own` or `progress` raises.
    """
    given = locals()
    ready()
    mappings('{"friction.static": 1.3}', set=set)
    end, goals = _end_and_goals(until)
    seconds = None if max_time is None else _seconds("max_time", max_time)
    parsed = parse(given, set=dict(set or {}) | _recorded(record), until=end)
    require(
        part is None or not own and accuracy is None,
        "part",
        part,
        "a part cannot have user-defined statistics or an accuracy",
        "use them in a run that is not split",
    )
    if accuracy is not None:
        with shown(progress) as callback:
            parsed, goal = _chosen(
                parsed,
                accuracy,
                statistic,
                seconds,
                threads,
                goals or paths or scheme or step or tolerance,
                callback,
            )
    warn([text for _, text in parsed.warnings(measures_bias=bias)])
    with shown(progress) as callback:
        made, remarks, estimates, state = _native.run(
            parsed,
            goals=goals,
            is_bounded=paths is not None,
            max_time=seconds,
            part=part,
            bias=bias,
            threads=threads,
            progress=callback,
            own=_own.shown(own),
        )
    warn(remarks)
    import numpy as np

    ds = dataset(made)
    if accuracy is not None:
        ds.attrs["accuracy"] = goal
    if state is not None:
        ds["part_state"] = ("part_state", np.frombuffer(state, dtype=np.uint8), _PART_STATE)
    return ds.merge(_own.estimates(own, estimates, {})) if own else ds


@public
def merge(
    parts: Sequence[xr.Dataset],
    *,
    bias: bool = True,
    threads: int | None = None,
    progress: Progress = True,
) -> xr.Dataset:
    """Join the parts of a run that `run(..., part=...)` made, like `mc merge`.

    Args:
        parts: the data sets of all parts of one run, in any order. They may come from several
            machines, and from files of `mc run --part`, but from one build of the program.
        bias: whether to estimate the bias of each statistic due to the time step. Parts
            have no such estimate, so it is made here.
        threads: number of threads for that estimate; one for each core if not given.
        progress: as for `run`.

    Returns:
        The data set that `run` would have returned for the whole run, bit for bit.

    Raises:
        ArgumentError: a part is missing, given twice, damaged, or of another run or program. The
            checks are those of `mc merge`.
    """
    given = []
    for number, ds in enumerate(parts):
        require(
            hasattr(ds, "data_vars") and "part" in ds.attrs and "part_state" in ds,
            "parts",
            f"parts[{number}]",
            "it is not a part",
            'give what run(..., part="1/4") returned, or the file of mc run --part',
        )
        given.append((f"parts[{number}]", raw(ds), ds.part_state.to_numpy().tobytes()))
    require(bool(given), "parts", "nothing", "no parts given", "give all parts of a run")
    with shown(progress) as callback:
        made, remarks = _native.merge(given, bias=bias, threads=threads, progress=callback)
    warn(remarks)
    return dataset(made)


def _chosen(
    parsed: _native.Scenario,
    accuracy: float,
    statistic: str | Sequence[str],
    seconds: float | None,
    threads: int | None,
    decided: object,
    callback: Callback,
) -> tuple[_native.Scenario, str]:
    """The scenario with the choice for an accuracy, and the text of the attribute `accuracy`."""
    problem = "it chooses scheme, step or tolerance, and paths, which another argument also sets"
    require(not decided, "accuracy", accuracy, problem, "remove one of them")
    within(1e-6, 0.5, accuracy=accuracy)
    named = [statistic] if isinstance(statistic, str) else list(statistic)
    return _native.choose(parsed, accuracy, named, seconds, threads, callback)


@public
def replay(run: xr.Dataset, path: int, *, progress: Progress = True) -> xr.Dataset:
    """Simulate one path of an ensemble again, with its events and its trajectory, like `mc replay`.

    Args:
        run: a data set that `run` returned, or `load` of the file of a run.
        path: number of the path, from 0 to the number of paths minus 1.
        progress: as for `run`.

    Returns:
        A data set like that of `run` for this one path, which is the path of the ensemble bit for
        bit. Its events are along `event`. Its trajectory, with the dimensions `trajectory` (of size
        1) and `time`, is as fine as the scheme resolves it.

    Raises:
        ArgumentError: the ensemble has no such path, or the data set is not that of a run.
    """
    with shown(progress) as callback:
        return dataset(_native.replay(of_run(run), path, callback))


def of_run(run: xr.Dataset, paths: int | None = None) -> _native.Scenario:
    """The scenario of the data set of a run, with what was measured. `paths` replaces its
    number of paths."""
    text = run.attrs.get("scenario")
    require(
        isinstance(text, str) and run.attrs.get("format_name") == "stick-slip ensemble",
        "run",
        type(run).__name__,
        "it is not the data set of a run",
        "give what run() returned, or load() of its file",
    )
    stored = []
    if "series_time" in run:
        times, values = run.series_time.values, run.series_temperature.values
        stored = [("temperature.series", times.copy(), values.copy())]
    for i, name in enumerate(run.input.values) if "input" in run else ():
        own = run.input_sample.values == i
        stored.append((f"input.{name}", run.input_time.values[own], run.input_value.values[own]))
    laid = [] if paths is None else [("paths =", "ensemble.paths", str(paths))]
    return _native.parse("run", text, laid, stored, are_stored=True)


def _end_and_goals(until: Until | None) -> tuple[float | str | None, list[str]]:
    """The end of the simulation and the goals. A goal is a text with a comparison."""
    if until is None or isinstance(until, (int, float)):
        return until, []
    all_of_them: list[Any] = [until] if isinstance(until, str) else list(until)
    ends = [text for text in all_of_them if "<" not in text]
    problem = "it has more than one end time"
    require(len(ends) < 2, "until", until, problem, "give at most one time")
    return (ends[0] if ends else None), [text for text in all_of_them if "<" in text]


def _recorded(record: Record | None) -> dict[str, Any]:
    """What is recorded, as keys of a scenario with values."""
    if record is None:
        return {}
    if isinstance(record, Mapping):
        return {f"record.{name}": value for name, value in record.items()}
    names = [record] if isinstance(record, str) else record
    return {f"record.{name}": True for name in names}
