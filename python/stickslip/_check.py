"""A scenario in full, what follows from it, and what to beware of."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ._scenario import ScenarioLike, Settings, parse


@dataclass(frozen=True)
class Check:
    """What `mc check` prints.

    Attributes:
        title: what the scenario asks, in a line.
        toml: all of it, every default visible. It is a scenario itself.
        derived: what follows from it, by name: numbers in units of the scenario, None where there is no such thing.
        warnings: sentences by name.
    """

    title: str
    toml: str
    derived: dict[str, float | int | list[float] | None]
    warnings: dict[str, str]


def check(
    scenario: ScenarioLike,
    *,
    paths: int | None = None,
    seed: int | None = None,
    scheme: str | None = None,
    step: float | None = None,
    tolerance: float | None = None,
    until: float | None = None,
    set: Settings | None = None,
    temperature: Any = None,
) -> Check:
    """Check a scenario without running it, like `mc check`.

    Args:
        scenario: path of a TOML file, TOML text, name of a shipped scenario, or a dictionary of tables.
        paths: number of paths [ensemble.paths].
        seed: seed [ensemble.seed].
        scheme: discrete-vi, corrected-vi, event-driven or quasi-static [scheme.kind].
        step: time step, of schemes that have one [time.step].
        tolerance: relative error that discretisation may leave, of the others [scheme.tolerance].
        until: end of the simulation [time.end].
        set: dotted keys with values, e.g. `{"friction.static": 1.3}`.
        temperature: measured temperature; see `run`.

    Raises:
        ScenarioError: something in the scenario is wrong; says where, and what would be right.
    """
    parsed = parse(
        scenario, set, temperature, paths=paths, seed=seed, scheme=scheme, step=step, tolerance=tolerance, until=until
    )
    return Check(parsed.title, parsed.toml, parsed.derived(), dict(parsed.warnings()))
