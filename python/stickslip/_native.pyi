"""The engine. Use the functions of `stickslip`, which say what they mean."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

VERSION: str
GIT_HASH: str
STATISTICS: list[str]

Variables = tuple[dict[str, Any], list[tuple[str, tuple[str, ...], npt.NDArray[Any], dict[str, Any]]]]

class Scenario:
    @property
    def title(self) -> str: ...
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
    overrides: Sequence[tuple[str | None, str, str]],
    samples: tuple[npt.NDArray[np.float64], npt.NDArray[np.float64]] | None = None,
    are_stored: bool = False,
) -> Scenario: ...
def shipped(name: str) -> str | None: ...
Handed = tuple[dict[str, Any], list[tuple[str, list[str], npt.NDArray[Any], dict[str, Any]]]]
Drawn = tuple[str | None, bool, float, bool]

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
    progress: Callable[[int, int], object] | None,
    own: list[tuple[str, Callable[..., Any]]],
) -> tuple[Variables, list[str], list[tuple[str, float, float, float, float]], bytes | None]: ...
def merge(
    scenario: Scenario,
    parts: list[tuple[Handed, bytes]],
    *,
    bias: bool,
    threads: int | None,
    progress: Callable[[int, int], object] | None,
) -> tuple[Variables, list[str]]: ...
def replay(scenario: Scenario, path: int) -> Variables: ...
def choose(
    scenario: Scenario, target: float, statistics: list[str], max_time: float | None, workers: int | None
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
    workers: int | None,
    progress: Callable[[int, int], object] | None,
) -> tuple[Variables, bool]: ...
def trade(scenario: Scenario, budget: float, workers: int | None) -> tuple[Variables, bool]: ...
def calibrate(
    name: str,
    text: str | None,
    overrides: list[tuple[str, str]],
    file: str | None,
    arrays: list[npt.NDArray[np.float64]] | None,
    *,
    method: str,
    fit: list[str],
    bounds: list[tuple[str, float, float]],
    starts: int,
    lag: float | None,
    interval: float,
    displacement: str | None,
    unit: str | None,
    workers: int | None,
) -> tuple[Variables, list[str]]: ...
def plot_scenario(scenario: Scenario, run: Handed | None, path: int, drawn: Drawn) -> Picture: ...
def plot_trade(trade: Handed, of: str | None, drawn: Drawn) -> Picture: ...
def plot_sweeps(sweeps: list[tuple[str, Handed]], of: str | None, drawn: Drawn) -> Picture: ...
def plot_calibration(calibration: Handed, drawn: Drawn) -> Picture: ...
