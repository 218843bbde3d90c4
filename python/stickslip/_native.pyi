"""The engine, without documentation. Use the functions of `stickslip`, which are documented."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

VERSION: str
GIT_HASH: str
STATISTICS: list[str]
SHIPPED: list[str]
OPTIONS: list[tuple[str, str]]

# A data set of the engine: its attributes, and for each variable its name, dimensions, values and
# attributes.
Variables = tuple[
    dict[str, Any], list[tuple[str, tuple[str, ...], npt.NDArray[Any], dict[str, Any]]]
]

# What is called with the numbers of paths done and expected, and with what is being done.
Callback = Callable[[int, int, str], object] | None

class Scenario:
    @property
    def title(self) -> str: ...
    @property
    def paths(self) -> int: ...
    @property
    def time_unit(self) -> str: ...
    @property
    def toml(self) -> str: ...
    def number_at(self, key: str) -> float | None: ...
    def derived(self) -> dict[str, float | int | list[float] | None]: ...
    def warnings(self, measures_bias: bool = False) -> list[tuple[str, str]]: ...

def parse(
    name: str,
    text: str | None,
    overrides: Sequence[tuple[str, str, str]],
    samples: Sequence[tuple[str, npt.NDArray[np.float64], npt.NDArray[np.float64]]] = (),
    are_stored: bool = False,
    drawn: Sequence[tuple[str, npt.NDArray[np.float64], Any]] = (),
) -> Scenario: ...
def key_meant(word: str) -> tuple[str, str] | None: ...
def option_meant(word: str, names: Sequence[str]) -> str | None: ...
def shipped(name: str) -> str | None: ...

# A data set that is handed to the engine, in the same form.
Handed = tuple[dict[str, Any], list[tuple[str, list[str], npt.NDArray[Any], dict[str, Any]]]]
# How a picture is drawn: the name of its only figure (None for all figures), whether it is dark,
# the width of a figure in millimetres, and whether vertical axes are logarithmic.
Drawn = tuple[str | None, bool, float, bool, str | None, list[tuple[str, str]]]

class Picture:
    @property
    def svg(self) -> str: ...
    def png(self, dots_per_inch: float = 300.0) -> bytes: ...
    def pdf(self) -> bytes: ...

def run(
    scenario: Scenario,
    *,
    goals: list[str],
    is_bounded: bool,
    max_time: float | None,
    part: str | None,
    bias: bool,
    threads: int | None,
    progress: Callback,
    own: list[Callable[..., Any]],
) -> tuple[Variables, list[str], list[list[float]], bytes | None]: ...
def merge(
    parts: list[tuple[str, Handed, bytes]],
    *,
    bias: bool,
    threads: int | None,
    progress: Callback,
) -> tuple[Variables, list[str]]: ...
def replay(scenario: Scenario, path: int, progress: Callback) -> Variables: ...
def motion(
    scenario: Scenario,
    overrides: Sequence[tuple[str, str, str]],
    times: npt.NDArray[np.float64],
    path: int,
) -> npt.NDArray[np.float64]: ...
def choose(
    scenario: Scenario,
    accuracy: float,
    statistic: list[str],
    max_time: float | None,
    threads: int | None,
    progress: Callback,
) -> tuple[Scenario, str]: ...
def sweep(
    scenario: Scenario,
    *,
    vary: list[str],
    zip: bool,
    elasticity: list[str],
    relative_step: float,
    independent: bool,
    bias: bool,
    own: list[Callable[..., Any]],
    threads: int | None,
    progress: Callback,
) -> tuple[Variables, list[list[list[float]]], bool]: ...
def trade(
    scenario: Scenario, budget: float, threads: int | None, progress: Callback
) -> tuple[Variables, bool]: ...

# A scenario: its name in messages, its text (None if the name is that of a file), and overrides as
# pairs of a key and a value in TOML.
Given = tuple[str, str | None, list[tuple[str, str]]]

def repaired(
    argument: str,
    quantity: str,
    times: npt.NDArray[np.float64],
    values: npt.NDArray[np.float64],
    outliers: int | None,
) -> tuple[npt.NDArray[np.float64], npt.NDArray[np.float64], list[str]]: ...

def calibrate(
    scenario: Given,
    measured: object,
    *,
    method: str,
    fit: list[str],
    bounds: list[tuple[str, float, float]],
    starts: int,
    lag: float | None,
    interval: float,
    threads: int | None,
    progress: Callback,
) -> tuple[Variables, list[str]]: ...
def forecast(
    scenario: Given,
    measured: object,
    *,
    draws: int,
    years: int,
    seed: int,
    interval: float,
    share: float,
    processes: int,
    threads: int | None,
    progress: Callback,
) -> tuple[Variables, list[str]]: ...

def fit_temperature(
    measured: object,
    *,
    processes: int,
    periods: list[float] | None,
    progress: Callback,
) -> tuple[dict[str, Any], list[str]]: ...
def twin(
    scenario: Given,
    temperature: list[npt.NDArray[np.float64]] | None,
    *,
    seed: int,
    noise: tuple[float, float, float],
    scatter: float,
    lag: float,
    resolution: float,
    spikes: float,
    gaps: int,
    drift: float,
    zero_set: tuple[float, float] | None,
    thermometer_every: int,
    start: str | None,
    duration: float,
    every: float,
    progress: Callback,
) -> tuple[Variables, list[str]]: ...
def checksum(path: str, is_compared: bool) -> bool | None: ...
def verify(
    run: Handed, threads: int | None, progress: Callback
) -> tuple[int, dict[str, Any] | None]: ...
def plot(
    scenario: Scenario | None,
    data: list[tuple[str, Handed]],
    path: int,
    statistic: str | None,
    drawn: Drawn,
) -> Picture: ...
