"""User-defined statistics: functions from the events of paths to one number per path."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Union

from .errors import mappings, require, wrong_argument

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt
    import xarray as xr


@dataclass(frozen=True)
class Events:
    """The events of consecutive paths: those of the first path in order of time, then those of the
    next path, and so on.

    All attributes but the first two are arrays with one entry for each event.

    Attributes:
        first_path: number of the first path.
        count: number of events of each path, with one entry for each path; 0 for a path that was
            lost because it diverged or was given up.
        time: time of the event, in the unit of time of the scenario.
        displacement: displacement x at the event, in the unit of length.
        force: total force without friction at the event, in the unit of force.
        sign: direction of the sub-phase that starts at the event, -1 or 1; 0 where a stick starts.
        kind: 0 where a stick starts, 1 where a slip starts, 2 between two sub-phases of a slip.
    """

    first_path: int
    count: npt.NDArray[np.uint32]
    time: npt.NDArray[np.float64]
    displacement: npt.NDArray[np.float64]
    force: npt.NDArray[np.float64]
    sign: npt.NDArray[np.int8]
    kind: npt.NDArray[np.int8]

    @property
    def path(self) -> npt.NDArray[np.intp]:
        """The index of the path of each event, from 0 for `first_path`; shape `(len(time),)`."""
        import numpy as np

        return np.repeat(np.arange(len(self.count)), self.count)

    def per_path(self, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
        """Sum the values of the events of each path.

        Args:
            values: one number for each event, or one truth value for each event to count.

        Returns:
            One sum for each path, of shape `(len(count),)`; 0 for a path without events.
        """
        import numpy as np

        weights = _real("values", "these", values)
        return np.bincount(self.path, weights, minlength=len(self.count)).astype(np.float64)


#: A function from the events of a block to one number for each path, whose mean over paths is
#: estimated, or to a pair of such arrays, the ratio of whose means is estimated.
Statistic = Callable[[Events], Union["npt.ArrayLike", "tuple[npt.ArrayLike, npt.ArrayLike]"]]


#: What the columns of the estimates mean.
_COLUMNS = {
    "own_estimate": "estimate",
    "own_standard_error": "standard error of the estimate, with paths as independent units",
    "own_interval_low": "lower end of the 95 % confidence interval",
    "own_interval_high": "upper end of the 95 % confidence interval",
}


def shown(own: Mapping[str, Statistic] | None) -> list[Callable[..., Any]]:
    """The functions that the engine calls. Each calls a function of the caller and checks its
    result."""
    example = '{"slips": lambda events: events.per_path(events.kind == 1)}'
    mappings(example, own=own)
    for name, statistic in (own or {}).items():
        problem, remedy = "it is not a function of the events", f"give a function, e.g. {example}"
        require(callable(statistic), "own", f"{name}: {statistic!r}", problem, remedy)
    return [_checked(name, statistic) for name, statistic in (own or {}).items()]


def estimates(own: Mapping[str, Statistic], columns: Any, axes: Mapping[Any, int]) -> xr.Dataset:
    """The estimates as variables along these axes, whose lengths are given, and `own`."""
    import numpy as np
    import xarray as xr

    columns = np.reshape(columns, (*axes.values(), len(own), len(_COLUMNS)))
    variables = {
        name: ((*axes, "own"), columns[..., i], {"long_name": meaning})
        for i, (name, meaning) in enumerate(_COLUMNS.items())
    }
    names = ("own", np.array([*own]), {"long_name": "user-defined statistic"})
    return xr.Dataset(variables, coords={"own": names})


def _checked(name: str, statistic: Statistic) -> Callable[..., Any]:
    import numpy as np

    def call(*columns: Any) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64] | None]:
        events = Events(*columns)
        given = statistic(events)
        parts: tuple[Any, ...] = given if isinstance(given, tuple) else (given,)
        numbers = [np.ascontiguousarray(_real("own", name, part)) for part in parts]
        shapes = ", ".join(str(part.shape) for part in numbers)
        require(
            len(numbers) < 3 and all(part.shape == events.count.shape for part in numbers),
            "own",
            name,
            f"it returned shapes {shapes} for {len(events.count)} paths",
            "return one number per path, or a pair of such arrays for a ratio",
        )
        problem = "it returned numbers that are not finite"
        is_finite = all(np.isfinite(part).all() for part in numbers)
        remedy = "return a finite number for each path, e.g. 0 for a path without events"
        require(is_finite, "own", name, problem, remedy)
        return numbers[0], (numbers[1] if len(numbers) > 1 else None)

    return call


def _real(argument: str, shown: str, values: Any) -> npt.NDArray[np.float64]:
    """The values as real numbers. Values that cannot be converted without loss are refused."""
    import numpy as np

    problem = None
    if np.ma.is_masked(values):
        problem = "it has masked values"
    elif np.iscomplexobj(values):
        problem = "it has imaginary parts"
    try:
        if problem is None:
            return np.asarray(values, dtype=np.float64)
    except (TypeError, ValueError) as error:
        problem = f"it is not an array of numbers ({error})"
    raise wrong_argument(argument, shown, problem, "give real numbers")
