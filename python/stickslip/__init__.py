"""Monte Carlo simulation of an oscillator with dry friction.

A body on a spring sticks while the force on it stays below a static threshold, and slips against a
dynamic one. A temperature with harmonics and noise drives it. The package simulates an ensemble of
paths of such a body, in memory, and returns statistics with confidence intervals as
`xarray.Dataset`.

The engine is that of the command `mc`: the same scenarios, the same messages, and the same results
to the last bit. A data set has the variables, dimensions, units and attributes of the file that the
command would write.

    import stickslip as ss
    ds = ss.run("rho025", paths=10_000)
    ds.estimate.sel(statistic="stick_duration_mean")
"""

from __future__ import annotations

from . import _native
from ._check import Check, check
from ._data import load
from ._frames import events, summary
from ._motion import Motion
from ._own import Events
from ._plot import Picture, plot
from ._run import merge, replay, run
from ._scenario import ScenarioLike, Scheme, scenarios
from ._studies import sweep, trade
from ._verify import Verified, verify
from .bearing import Layout, Weather, calibrate, fit_temperature, forecast, twin
from .errors import (
    ArgumentError,
    RunError,
    ScenarioError,
    StickSlipError,
    StickSlipWarning,
    VerificationError,
)

#: Version of the package. It is also the version of the command.
__version__: str = _native.VERSION

#: Names of all statistics, in the order of the coordinate `statistic`.
STATISTICS: tuple[str, ...] = tuple(_native.STATISTICS)

__all__ = [
    "STATISTICS",
    "ArgumentError",
    "Check",
    "Events",
    "Layout",
    "Motion",
    "Picture",
    "RunError",
    "ScenarioError",
    "ScenarioLike",
    "Scheme",
    "StickSlipError",
    "StickSlipWarning",
    "VerificationError",
    "Verified",
    "Weather",
    "calibrate",
    "check",
    "events",
    "fit_temperature",
    "forecast",
    "load",
    "merge",
    "plot",
    "replay",
    "run",
    "scenarios",
    "summary",
    "sweep",
    "trade",
    "twin",
    "verify",
]
