"""An ensemble, and one path of it again."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from datetime import timedelta
from typing import TYPE_CHECKING, Any, Union

from . import _native, _own
from ._data import dataset, raw, ready, warn
from ._own import Statistic
from ._progress import Progress, shown
from ._scenario import ScenarioLike, Settings, parse
from .errors import ArgumentError, wrong_argument

if TYPE_CHECKING:
    import xarray as xr

#: A time, which ends the simulation of each path, or goals such as "stick_duration_mean < 0.5%", which end the run.
Until = Union[float, str, Sequence[str]]

#: What is kept of single paths: names of `paths`, `events`, or a dictionary with `trajectories` as well.
Record = Union[str, Sequence[str], Mapping[str, Any]]


def run(
    scenario: ScenarioLike,
    *,
    paths: int | None = None,
    seed: int | None = None,
    scheme: str | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    until: Until | None = None,
    set: Settings | None = None,
    record: Record | None = None,
    temperature: Any = None,
    accuracy: float | None = None,
    statistic: str | Sequence[str] = (),
    max_time: float | timedelta | None = None,
    part: str | None = None,
    bias: bool = True,
    own: Mapping[str, Statistic] | None = None,
    threads: int | None = None,
    progress: Progress = None,
) -> xr.Dataset:
    """Simulate an ensemble and return its statistics, like `mc run`.

    The result is what `xarray.open_dataset` makes of the file that `mc run` writes: the same variables, dimensions, attributes and
    bits, for any number of threads. Ctrl-C ends it within 0.3 s; what is done by then is returned, with the attribute `status`
    "interrupted".

    Args:
        scenario: path of a TOML file, TOML text, name of a shipped scenario, or a dictionary of tables.
        paths: number of paths [ensemble.paths]; with a goal, at most so many.
        seed: seed [ensemble.seed].
        scheme: discrete-vi, corrected-vi, event-driven or quasi-static [scheme.kind].
        step: time step, of schemes that have one, in the scenario's unit of time [time.step].
        tolerance: relative error that discretisation may leave, of the other schemes [scheme.tolerance].
        until: end of the simulation [time.end], or a goal "NAME < 0.5%" or several: simulate until the standard errors are so small.
        set: dotted keys with values, e.g. `{"friction.static": 1.3}`.
        record: what is kept of single paths: "events", ["paths", "events"], or `{"events": True, "trajectories": 3}`.
        temperature: measured temperature in the place of `[temperature.series]`: a pandas Series or one-dimensional DataArray along
            time, or a pair (times, values). Dates become seconds since the first of them.
        accuracy: choose scheme, step or tolerance, and number of paths for this relative error, e.g. 0.01, from a pilot of some seconds.
        statistic: the statistics that are to be so accurate; all if not given.
        max_time: end in time for this limit, in seconds.
        part: simulate one part of the run only, e.g. "3/16"; `merge` joins them.
        bias: whether the bias of the step is estimated, which takes up to an eighth of the time.
        own: statistics of your own by name: functions of the `Events` of a block of paths that give one number of each path, whose
            mean is estimated, or a pair of such arrays, the ratio of whose means is.
        threads: number of threads, one a core if not given.
        progress: True for a bar of tqdm, or a callable that is told paths done and paths expected, some times a second.

    Returns:
        Statistics along `statistic` with intervals and biases, curves along `time`, histograms along `duration_bin` and `sub_phase`,
        rows along `path`, `event` and `trajectory` where they are recorded. `docs/output-format.md` lists every variable. Statistics of
        your own are `own_estimate`, `own_standard_error`, `own_interval_low` and `own_interval_high` along `own`; their intervals hold
        with 95 %, the path being the independent unit, as those of the others do.

    Raises:
        ScenarioError: something in the scenario is wrong; says where, and what would be right.
        ArgumentError: an argument is wrong.
        RunError: the time was up before the first paths were done.
        KeyboardInterrupt: Ctrl-C came before the first paths were done.
    """
    ready()
    end, goals = _end_and_goals(until)
    seconds = _seconds(max_time)
    settings = dict(set or {}) | _recorded(record)
    parsed = parse(
        scenario, settings, temperature, paths=paths, seed=seed, scheme=scheme, step=step, tolerance=tolerance, until=end
    )
    if part is not None and (own or accuracy is not None):
        raise wrong_argument(
            "part", part, "a part has neither statistics of your own nor an accuracy", "give them to a run in one piece"
        )
    if accuracy is not None:
        parsed, promise = _chosen(parsed, accuracy, statistic, seconds, threads, goals or paths or scheme or step or tolerance)
    warn([text for _, text in parsed.warnings(measures_bias=bias)])
    with shown(progress) as told:
        made, remarks, estimates, sums = _native.run(
            parsed,
            goals=goals,
            is_bounded=paths is not None,
            max_time=seconds,
            part=part,
            bias=bias,
            threads=threads,
            progress=told,
            own=_own.shown(own),
        )
    warn(remarks)
    import numpy as np

    ds = dataset(made)
    if accuracy is not None:
        ds.attrs["accuracy"] = promise
    if sums is not None:
        ds["part_sums"] = ("part_sum", np.frombuffer(sums, dtype=np.uint8))
    return ds.merge(_of_own(estimates)) if estimates else ds


def merge(
    parts: Sequence[xr.Dataset], *, bias: bool = True, threads: int | None = None, progress: Progress = None
) -> xr.Dataset:
    """Join the parts of a run that `run(..., part=...)` made, in any order, like `mc merge`.

    Args:
        parts: all parts of one run, made on whatever machines by one version of the package.
        bias: whether the bias of the step is estimated, which is done here.
        threads: number of threads for that.
        progress: as for `run`.

    Returns:
        The data set of the run in one piece, bit for bit.

    Raises:
        ArgumentError: a part is missing, given twice, or of another run or version.
    """
    given = {}
    for ds in parts:
        name = ds.attrs.get("part")
        if not isinstance(name, str) or "part_sums" not in ds:
            raise _wrong_parts("a data set", "it is no part", 'give what run(..., part="1/4") returned')
        if name in given:
            raise _wrong_parts(name, "it is given twice", "leave out one of them")
        given[name] = ds
    if not given:
        raise _wrong_parts("nothing", "there are no parts", "give all parts of a run")
    first = next(iter(given.values()))
    count = int(first.attrs["part"].split("/")[1])
    for name, ds in given.items():
        for key in ("scenario", "program_version", "git_hash", "generator", "block_size", "paths"):
            if ds.attrs.get(key) != first.attrs.get(key):
                raise _wrong_parts(name, f"its attribute `{key}` is another one", "give the parts of one run, made by one version")
    wanted = [f"{number}/{count}" for number in range(1, count + 1)]
    missing = [name for name in wanted if name not in given]
    if missing or len(given) > count:
        raise _wrong_parts(", ".join(missing) or "too many", "missing, or cut otherwise", "give all parts of one run")
    with shown(progress) as told:
        handed = [(raw(given[name]), given[name].part_sums.to_numpy().tobytes()) for name in wanted]
        made, remarks = _native.merge(of_run(first), handed, bias=bias, threads=threads, progress=told)
    warn(remarks)
    return dataset(made)


def _wrong_parts(value: str, problem: str, remedy: str) -> ArgumentError:
    return wrong_argument("parts", value, problem, remedy)


def _chosen(
    parsed: _native.Scenario, accuracy: float, statistic: str | Sequence[str], seconds: float | None, threads: int | None, decided: object
) -> tuple[_native.Scenario, str]:
    """The scenario with what was chosen for an accuracy, and the promise."""
    if decided:
        raise wrong_argument(
            "accuracy", accuracy, "it chooses scheme, step or tolerance, and paths, and something else does so as well",
            "leave out one of them",
        )
    if not 1e-6 <= accuracy <= 0.5:
        raise wrong_argument("accuracy", accuracy, "it is no relative error that can be reached", "give 1e-6 to 0.5")
    named = [statistic] if isinstance(statistic, str) else list(statistic)
    return _native.choose(parsed, accuracy, named, seconds, threads)


def _of_own(estimates: list[tuple[str, float, float, float, float]]) -> xr.Dataset:
    """Statistics of the caller's own as variables."""
    import numpy as np
    import xarray as xr

    names = [name for name, *_ in estimates]
    columns = np.array([numbers for _, *numbers in estimates])
    meanings = {
        "own_estimate": "estimate",
        "own_standard_error": "standard error of the estimate, the path being the independent unit",
        "own_interval_low": "lower end of the 95 % confidence interval",
        "own_interval_high": "upper end of the 95 % confidence interval",
    }
    variables = {
        name: ("own", columns[:, i], {"long_name": meaning}) for i, (name, meaning) in enumerate(meanings.items())
    }
    return xr.Dataset(variables, coords={"own": ("own", np.array(names), {"long_name": "statistic of the caller's own"})})


def replay(run: xr.Dataset, path: int) -> xr.Dataset:
    """Simulate one path of an ensemble again, with its events and as fine a trajectory as it has, like `mc replay`.

    Args:
        run: what `run` returned, or `load` of its file.
        path: number of the path, from 0.

    Returns:
        The data set of this one path: it is the path of the ensemble, bit for bit.

    Raises:
        ArgumentError: the ensemble has no such path, or the data set is not that of a run.
    """
    return dataset(_native.replay(of_run(run), path))


def of_run(run: xr.Dataset, paths: int | None = None) -> _native.Scenario:
    """The scenario that a data set was run with, its measured temperature included; with so many paths, if another number is meant."""
    text = run.attrs.get("scenario")
    if not isinstance(text, str) or run.attrs.get("format_name") != "stick-slip ensemble":
        raise wrong_argument(
            "run", type(run).__name__, "it is not the data set of a run", "give what run() returned, or load() of its file"
        )
    stored = None
    if "series_time" in run:
        stored = (run.series_time.to_numpy().copy(), run.series_temperature.to_numpy().copy())
    laid = [] if paths is None else [("--paths", "ensemble.paths", str(paths))]
    return _native.parse("run", text, laid, stored, are_stored=True)


def _end_and_goals(until: Until | None) -> tuple[float | str | None, list[str]]:
    """The end of the simulation, and goals: a goal compares, a time does not."""
    if until is None or isinstance(until, (int, float)):
        return until, []
    all_of_them = [until] if isinstance(until, str) else list(until)
    ends = [text for text in all_of_them if "<" not in text]
    if len(ends) > 1:
        raise wrong_argument("until", until, "it has more than one end of the simulation", "give one time, and goals")
    return (ends[0] if ends else None), [text for text in all_of_them if "<" in text]


def _recorded(record: Record | None) -> dict[str, Any]:
    """What is recorded, as keys of a scenario."""
    if record is None:
        return {}
    if isinstance(record, Mapping):
        return {f"record.{name}": value for name, value in record.items()}
    names = [record] if isinstance(record, str) else record
    return {f"record.{name}": True for name in names}


def _seconds(time: float | timedelta | None) -> float | None:
    seconds = time.total_seconds() if isinstance(time, timedelta) else time
    if seconds is not None and not 0 < seconds < 1e9:
        raise wrong_argument("max_time", time, "it is no time", "give a positive number of seconds, or a timedelta")
    return seconds
