"""The motion of one path at given times, for fits and optimisers."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from . import _native
from ._public import public
from ._scenario import ScenarioLike, Scheme, Settings, overrides, parse
from .errors import require

if TYPE_CHECKING:
    import numpy as np
    import numpy.typing as npt


class Motion:
    """One path of a scenario, whose numbers can be changed at every call.

    The scenario and its measurements are read once, so that a call without noise takes a fraction
    of a millisecond. Between events, x and x' are those of the scheme to about ten digits, and they
    change smoothly with the numbers of the scenario as long as the order of sticks and slips stays
    the same.

    Args:
        scenario, scheme, step, tolerance, until, set, temperature, inputs: as for `run`; `until` is
            a time.
        path: number of the path in the ensemble; without noise, all paths are the same.
    """

    @public
    def __init__(
        self,
        scenario: ScenarioLike,
        *,
        scheme: Scheme | None = None,
        step: float | None = None,
        tolerance: float | None = None,
        until: float | None = None,
        set: Settings | None = None,
        temperature: Any = None,
        inputs: Mapping[str, Any] | None = None,
        path: int = 0,
    ) -> None:
        require(path >= 0, "path", path, "must be 0 or above", "give the number of a path")
        self._scenario, self._path = parse(locals()), path

    def at(
        self, times: npt.ArrayLike, set: Settings | None = None
    ) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]]:
        """Displacement and velocity at these times.

        Args:
            times: from 0 to `time.end`, in the unit of time of the scenario.
            set: numbers of the scenario that differ in this call, e.g. {"friction.static": 1.3}.

        Returns:
            Two arrays with one value per time, in the units of the scenario.

        Raises:
            ScenarioError: a number is invalid, e.g. a negative friction.
            RunError: the path diverges, or is given up.
            ArgumentError: a time is outside the run.
        """
        import numpy as np

        at = np.atleast_1d(np.asarray(times, dtype=float))
        displacement, velocity = _native.motion(self._scenario, overrides(set), at, self._path)
        return displacement, velocity
