"""Results as data frames of pandas: the events, and one row for each statistic."""

from __future__ import annotations

import functools
import math
import re
from typing import TYPE_CHECKING, Any

from ._public import public
from .errors import require

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

#: Names of the kinds of events, in the order of their numbers.
_KINDS = ("stick_entered", "slip_started", "sub_phase_boundary")

#: The columns of numbers of a summary.
_NUMBERS = (
    "estimate",
    "standard_error",
    "interval_low",
    "interval_high",
    "bias",
    "bias_uncertainty",
    "estimate_corrected",
    "estimate_corrected_low",
    "estimate_corrected_high",
)


@public
def events(ds: xr.Dataset) -> pd.DataFrame:
    """The events of the paths as a data frame with one row for each event.

    `ds.to_dataframe()` would combine every event with every path.

    Args:
        ds: a data set that `run(..., record="events")`, `merge` or `replay` returned, or `load` of
            a file of them.

    Returns:
        The events of the first path in order of time, then those of the next path, and so on. The
        columns are `path`, the number of the path; `time` in the unit of time of the scenario;
        `displacement` and `force`, the total force without friction, at the event; `sign`, the
        direction of the sub-phase that starts, -1 or 1, or 0 where a stick starts; and `kind`, the
        category "stick_entered", "slip_started" or "sub_phase_boundary". The attributes
        `attrs["units"]` of the frame hold the units by column.

    Raises:
        ArgumentError: the data set has no events, or is only a selection of paths.
        ModuleNotFoundError: pandas is not installed.
    """
    pandas = _pandas()
    import numpy as np

    has_events = "event_count" in ds and "event_time" in ds
    remedy = 'record them: run(..., record="events")'
    require(has_events, "ds", type(ds).__name__, "it has no events", remedy)
    count = ds.event_count.to_numpy()
    require(
        count.sum() == ds.sizes["event"],
        "ds",
        f"{len(count)} paths",
        f"they have {count.sum()} events, but the data set has {ds.sizes['event']}",
        "pass the whole data set, and select rows of the frame",
    )
    columns: dict[str, Any] = {"path": np.repeat(ds["path"].to_numpy(), count)}
    for name in ("time", "displacement", "force", "sign"):
        columns[name] = ds[f"event_{name}"].to_numpy()
    columns["kind"] = pandas.Categorical.from_codes(ds.event_kind.to_numpy(), _KINDS)
    frame = pandas.DataFrame(columns)
    with_units = ("time", "displacement", "force")
    frame.attrs["units"] = {n: ds[f"event_{n}"].attrs.get("units", "") for n in with_units}
    return frame


@public
def summary(ds: xr.Dataset) -> pd.DataFrame:
    """The statistics as a data frame with one row for each, like `arviz.summary`.

    Args:
        ds: a data set that `run`, `merge` or `sweep` returned, or `load` of a file of them.

    Returns:
        The names of the statistics are the index; for a sweep its axes, or its points, come before
        them in the index. `.to_latex()` writes the estimates, their 95 % intervals and their units as a
        table, with the digits that the standard errors support. The columns are `estimate`, `standard_error`, the 95 % confidence
        interval from `interval_low` to `interval_high`, `bias` with `bias_uncertainty`,
        `estimate_corrected` with its 95 % interval from `estimate_corrected_low` to
        `estimate_corrected_high`, `unit` and `long_name`. Unknown
        numbers are NaN, and dimensionless statistics have the unit "1". The last rows are
        user-defined statistics, if the run has any; they have no unit.

    Raises:
        ArgumentError: the data set has no statistics.
        ModuleNotFoundError: pandas is not installed.
    """
    pandas = _pandas()
    require(
        "statistic" in ds.dims and "estimate" in ds,
        "ds",
        ds.attrs.get("format_name", type(ds).__name__),
        "it has no statistics along `statistic`",
        "give what run(), merge() or sweep() returned",
    )
    axes = [str(axis) for axis in ds.estimate.dims]
    there = [name for name in _NUMBERS if name in ds]
    units = {"unit": ds.statistic_unit, "long_name": ds.statistic_long_name}
    # Coordinates that are not axes would be columns of their own.
    of_numbers = ds[there].reset_coords(drop=True).assign(
        {name: texts.reset_coords(drop=True).astype(str) for name, texts in units.items()}
    )
    frame = of_numbers.to_dataframe(dim_order=axes)
    if "own_estimate" in ds:
        own = {name: ds[f"own_{name}"] for name in _NUMBERS[:4]}
        mine = type(ds)(own).reset_coords(drop=True).to_dataframe(dim_order=[*axes[:-1], "own"])
        mine = mine.rename_axis(index={"own": "statistic"}).assign(unit="", long_name="")
        frame = pandas.concat([frame, mine])
    return _summary_frame()(frame.reindex(columns=[*_NUMBERS, *units]))


@functools.cache
def _summary_frame() -> Any:
    """The class of a summary: a frame that knows how its numbers are printed."""
    pandas = _pandas()

    class SummaryFrame(pandas.DataFrame):  # type: ignore[misc,name-defined]
        @property
        def _constructor(self) -> Any:
            return SummaryFrame

        def to_latex(self, *args: Any, **options: Any) -> Any:
            """The table in LaTeX, for the package booktabs; with arguments, as pandas writes it."""
            if args or options or not {*_NUMBERS[:4], "unit", "long_name"} <= {*self.columns}:
                return super().to_latex(*args, **options)
            return _latex(self)

    SummaryFrame.__qualname__ = "SummaryFrame"
    return SummaryFrame


def __getattr__(name: str) -> Any:
    """The class of a summary, for pickle."""
    if name == "SummaryFrame":
        return _summary_frame()
    raise AttributeError(name)


def _latex(frame: pd.DataFrame) -> str:
    """A `tabular` with a row for each statistic."""
    axes = [_escaped(str(name)) for name in frame.index.names[:-1]]
    lines = [" & ".join([*axes, "statistic", "estimate", r"95 \% interval", "unit"])]
    for label, row in zip(frame.index, frame.itertuples()):
        *places, name = label if isinstance(label, tuple) else (label,)
        shown = _digits(row.estimate, row.standard_error)
        interval = " to ".join(map(shown, (row.interval_low, row.interval_high)))
        is_known = math.isfinite(row.interval_low) and math.isfinite(row.interval_high)
        cells = [*map(str, places), row.long_name or str(name)]
        numbers = [shown(row.estimate), interval if is_known else ""]
        lines.append(" & ".join([*map(_escaped, cells), *numbers, _latex_unit(row.unit)]))
    head, *body = [line + r" \\" for line in lines]
    rows = "\n".join(body)
    columns = "l" * (len(axes) + 1) + "rrl"
    return (
        "% needs \\usepackage{booktabs}\n"
        f"\\begin{{tabular}}{{{columns}}}\n\\toprule\n{head}\n\\midrule\n{rows}\n"
        "\\bottomrule\n\\end{tabular}\n"
    )


def _digits(estimate: float, error: float) -> Any:
    """Writes numbers with two digits of the error of an estimate, or seven digits without one."""

    def power(x: float) -> int:
        return math.floor(math.log10(x)) if x > 0 and math.isfinite(x) else 0

    is_sure = math.isfinite(error) and error > 0
    largest = power(max(abs(estimate), error if is_sure else 0))
    last = power(error) - 1 if is_sure else largest - 6
    exponent = 0 if -3 <= largest <= 6 else largest

    def shown(x: float) -> str:
        if not math.isfinite(x):
            return "none"
        scaled = f"{x / 10.0**exponent:.{max(exponent - last, 0)}f}"
        return f"${scaled}$" if exponent == 0 else rf"${scaled}\times10^{{{exponent}}}$"

    return shown


def _escaped(text: str) -> str:
    return re.sub(r"([_%&#${}])", r"\\\1", text)


def _latex_unit(unit: str) -> str:
    """A unit in the notation of UDUNITS, such as `m2 s-1`."""
    if unit in ("", "1"):
        return ""
    factors = [re.sub(r"^(.*?[^\d-])(-?\d+)$", r"\1^{\2}", factor) for factor in unit.split()]
    return r"$\mathrm{" + r"\,".join(factors) + "}$"


def _pandas() -> Any:
    """The module pandas, which is imported only where a frame is made."""
    try:
        import pandas
    except ModuleNotFoundError:
        raise ModuleNotFoundError(
            "events() and summary() return data frames of pandas, which is not installed\n"
            "  fix: pip install pandas"
        ) from None
    return pandas
